// A character in WebGL 2: a vertex shader turns the parameters of a frame into the mesh, which transform
// feedback gives back. Its data are attributes of the vertices; the basis of the details, the weights of its
// planes and the motions of the bones are textures.
import type {Pose} from '../math/skeleton';
import {boneMotions} from './bone_motions';
import {kInfluences, type PageCharacter} from './page_character';

const kWidth = 4096;  // texels of a row of the planes; a texture has at most as many rows

const kVertexShader = `#version 300 es
precision highp float;
precision highp int;
precision highp isampler2D;
layout(location = 0) in vec3 rest;
layout(location = 1) in vec3 mean;
layout(location = 2) in uvec4 bonesA;
layout(location = 3) in uvec4 bonesB;
layout(location = 4) in vec4 weightsA;
layout(location = 5) in vec4 weightsB;
layout(location = 6) in uvec3 part;  // first texel of the vertex, first weight of its part, number of planes
layout(location = 7) in float strength;
uniform isampler2D planes;
uniform sampler2D planeWeights;
uniform sampler2D motions;
uniform bool detailed;
out vec3 position;

vec3 rotated(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }

void main() {
  vec3 skinned = vec3(0.0);
  vec4 axes = vec4(0.0), strongest = texelFetch(motions, ivec2(3, bonesA[0]), 0);
  for (int k = 0; k < ${kInfluences}; ++k) {
    float weight = k < 4 ? weightsA[k] : weightsB[k - 4];
    if (weight == 0.0) continue;
    int bone = int(k < 4 ? bonesA[k] : bonesB[k - 4]);
    vec4 at = vec4(rest, 1.0), turn = texelFetch(motions, ivec2(3, bone), 0);
    skinned += weight * vec3(dot(texelFetch(motions, ivec2(0, bone), 0), at), dot(texelFetch(motions, ivec2(1, bone), 0), at),
                             dot(texelFetch(motions, ivec2(2, bone), 0), at));
    axes += weight * (dot(turn, strongest) < 0.0 ? -turn : turn);
  }
  position = skinned;
  if (!detailed) return;
  vec3 detail = mean;
  for (uint p = 0u; p < part.z; ++p) {
    uint texel = part.x + p, weight = part.y + p;
    detail += texelFetch(planeWeights, ivec2(weight % ${kWidth}u, weight / ${kWidth}u), 0).x
      * vec3(texelFetch(planes, ivec2(texel % ${kWidth}u, texel / ${kWidth}u), 0).xyz);
  }
  position += rotated(normalize(axes), strength * detail);
}`;
const kFragmentShader = `#version 300 es
precision highp float;
void main() {}`;

export class ShaderCharacter {
  private readonly gl: WebGL2RenderingContext;
  private readonly program: WebGLProgram;
  private readonly array: WebGLVertexArrayObject;
  private readonly feedback: WebGLTransformFeedback;
  private readonly strengths: WebGLBuffer;
  private readonly planeWeights: Float32Array;
  private readonly weightsTexture: WebGLTexture;
  private readonly motionsTexture: WebGLTexture;
  private readonly target: WebGLBuffer;
  private shownStrengths: Float32Array | null = null;

  // Throws where the browser has no WebGL 2, or not enough of it for this character.
  constructor(readonly character: PageCharacter) {
    const gl = new OffscreenCanvas(1, 1).getContext('webgl2', {failIfMajorPerformanceCaveat: false});
    if (!gl) throw new Error('there is no WebGL 2');
    this.gl = gl;
    const rows = Math.max(1, Math.ceil(character.planes.length / 3 / kWidth));
    if (kWidth > gl.getParameter(gl.MAX_TEXTURE_SIZE) || rows > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new Error('the character is too large for a texture');
    const numWeights = character.head.parts.reduce((sum, part) => sum + part.scales.length, 0);
    this.planeWeights = new Float32Array(kWidth * Math.max(1, Math.ceil(numWeights / kWidth)));
    this.program = link(gl);
    gl.useProgram(this.program);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const padded = new Int8Array(3 * kWidth * rows);
    padded.set(character.planes);
    this.texture(0, 'planes', gl.RGB8I, kWidth, rows, gl.RGB_INTEGER, gl.BYTE, padded);
    this.weightsTexture = this.texture(1, 'planeWeights', gl.R32F, kWidth, this.planeWeights.length / kWidth, gl.RED, gl.FLOAT, this.planeWeights);
    this.motionsTexture = this.texture(2, 'motions', gl.RGBA32F, 4, character.head.num_joints, gl.RGBA, gl.FLOAT, null);
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    this.strengths = this.attributes();
    this.target = gl.createBuffer();
    this.feedback = gl.createTransformFeedback();
    gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, this.feedback);
    gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, this.target);
    gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, 12 * character.head.num_vertices, gl.DYNAMIC_READ);
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, this.target);
    gl.enable(gl.RASTERIZER_DISCARD);
    if (gl.getError() !== gl.NO_ERROR) throw new Error('WebGL 2 refuses the character');
  }

  // The mesh of one frame. coefficients: r, or none for skinning alone; strengths: V, or null for 1.
  evaluate(pose: Pose, boneScales: readonly number[], coefficients: ArrayLike<number>, strengths: Float32Array | null): Float32Array {
    const {gl, character} = this, detailed = coefficients.length > 0;
    if (detailed) this.weigh(coefficients);
    gl.activeTexture(gl.TEXTURE2);
    gl.bindTexture(gl.TEXTURE_2D, this.motionsTexture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 4, character.head.num_joints, gl.RGBA, gl.FLOAT, boneMotions(character, pose, boneScales, detailed));
    if (strengths !== this.shownStrengths) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.strengths);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, strengths ?? new Float32Array(character.head.num_vertices).fill(1));
      this.shownStrengths = strengths;
    }
    gl.uniform1i(gl.getUniformLocation(this.program, 'detailed'), detailed ? 1 : 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, this.target);
    gl.beginTransformFeedback(gl.POINTS);
    gl.drawArrays(gl.POINTS, 0, character.head.num_vertices);
    gl.endTransformFeedback();
    const positions = new Float32Array(3 * character.head.num_vertices);
    gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, positions);
    if (gl.isContextLost()) throw new Error('WebGL has lost its context');
    return positions;
  }

  private weigh(coefficients: ArrayLike<number>): void {
    const {gl} = this;
    let at = 0;
    for (const {coefficients: taken, scales} of this.character.head.parts) {
      for (let p = 0; p < scales.length; ++p) this.planeWeights[at++] = scales[p]! * coefficients[taken[p]!]!;
    }
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.weightsTexture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kWidth, this.planeWeights.length / kWidth, gl.RED, gl.FLOAT, this.planeWeights);
  }
  private texture(unit: number, name: string, format: number, width: number, height: number, layout: number, type: number,
                  values: ArrayBufferView | null): WebGLTexture {
    const {gl} = this, texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, gl.NEAREST);
    gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, layout, type, values);
    gl.uniform1i(gl.getUniformLocation(this.program, name), unit);
    return texture;
  }
  // Returns the buffer of the strengths, which change.
  private attributes(): WebGLBuffer {
    const {gl, character} = this, {head, partVertices} = character, numVertices = head.num_vertices;
    const part = new Uint32Array(3 * numVertices), mean = new Float32Array(3 * numVertices);
    let place = 0, texel = 0, weight = 0;
    for (const {num_vertices, scales} of head.parts) {
      for (let i = 0; i < num_vertices; ++i, ++place, texel += scales.length) {
        part.set([texel, weight, scales.length], 3 * partVertices[place]!);
        mean.set(character.mean.subarray(3 * place, 3 * place + 3), 3 * partVertices[place]!);
      }
      weight += scales.length;
    }
    const add = (values: ArrayBufferView): WebGLBuffer => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      return buffer;
    };
    const point = (location: number): void => gl.enableVertexAttribArray(location);
    [0, 1, 2, 3, 4, 5, 6, 7].forEach(point);
    add(character.rest);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    add(mean);
    gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 0, 0);
    add(character.bones);
    gl.vertexAttribIPointer(2, 4, gl.UNSIGNED_BYTE, kInfluences, 0);
    gl.vertexAttribIPointer(3, 4, gl.UNSIGNED_BYTE, kInfluences, 4);
    add(character.weights);
    gl.vertexAttribPointer(4, 4, gl.FLOAT, false, 4 * kInfluences, 0);
    gl.vertexAttribPointer(5, 4, gl.FLOAT, false, 4 * kInfluences, 16);
    add(part);
    gl.vertexAttribIPointer(6, 3, gl.UNSIGNED_INT, 0, 0);
    const strengths = add(new Float32Array(numVertices).fill(1));
    gl.vertexAttribPointer(7, 1, gl.FLOAT, false, 0, 0);
    return strengths;
  }
}

function link(gl: WebGL2RenderingContext): WebGLProgram {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, kVertexShader], [gl.FRAGMENT_SHADER, kFragmentShader]] as const) {
    const shader = gl.createShader(type)!;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`shader: ${gl.getShaderInfoLog(shader)}`);
    gl.attachShader(program, shader);
  }
  gl.transformFeedbackVaryings(program, ['position'], gl.INTERLEAVED_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`shader: ${gl.getProgramInfoLog(program)}`);
  return program;
}
