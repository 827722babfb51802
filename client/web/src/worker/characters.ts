// Characters that were downloaded for the shader. One that cannot be shown by it, or is shown more slowly than
// frames would be decoded, is null.
import type {FramesChoice} from './messages';
import {readPageCharacter} from './page_character';
import {ShaderCharacter} from './shader_character';

const kMost = 2;  // characters that are kept
const kSlowMs = 12;  // software renderers are above, any graphics card is below

const kept = new Map<string, Promise<ShaderCharacter | null>>();

export function characterFor(modelId: string, token: string, choice: FramesChoice): Promise<ShaderCharacter | null> {
  if (choice === 'mesh' || typeof OffscreenCanvas === 'undefined' || typeof DecompressionStream === 'undefined') return Promise.resolve(null);
  const key = `${modelId} ${choice}`;
  let character = kept.get(key);
  if (!character) {
    character = load(modelId, token, choice).catch((error: unknown) => {
      if (choice === 'parameters') console.warn(`frames come as meshes: ${String(error)}`);
      return null;
    });
    kept.set(key, character);
    for (const other of kept.keys()) if (kept.size > kMost) kept.delete(other);
  }
  return character;
}

async function load(modelId: string, token: string, choice: FramesChoice): Promise<ShaderCharacter | null> {
  const response = await fetch(`/studio/models/${modelId}/page`, {cache: 'no-store', credentials: 'omit',
    headers: {'X-Pleat-Studio': '1', ...(token ? {Authorization: `Bearer ${token}`} : {})}});
  if (!response.ok) throw new Error(`the character was refused: ${response.status}`);
  const shader = new ShaderCharacter(readPageCharacter(await response.arrayBuffer()));
  return choice === 'parameters' || milliseconds(shader) < kSlowMs ? shader : null;
}
function milliseconds(shader: ShaderCharacter): number {
  const {head} = shader.character, rest = {root: head.joints[0]!.rest, rotations: head.joints.map(() => [1, 0, 0, 0] as const)};
  const coefficients = new Float32Array(head.num_coefficients);
  let least = Infinity;
  for (let i = 0; i < 3; ++i) {  // the first one compiles
    const start = performance.now();
    shader.evaluate(rest, [], coefficients, null);
    least = Math.min(least, performance.now() - start);
  }
  return least;
}
