// The worker of the page: it holds the live sessions, decodes their frames and computes normals, so
// that the page's own thread only draws.
import {create, fromBinary, toBinary} from '@bufbuild/protobuf';
import {FrameEncoding, LiveSessionRequestSchema, LiveSessionResponseSchema, StreamContent, type Frame, type LiveReport,
  type StreamHeader} from '../generated/pleat/v1/pose_service_pb';
import type {Pose} from '../math/skeleton';
import {characterFor} from './characters';
import {loadDraco} from './draco';
import {MeshFrames, ParameterFrames, type Frames} from './frames';
import type {FromWorker, OpenSession, ShowPose, ToWorker} from './messages';
import {computeNormals} from './normals';
import type {ShaderCharacter} from './shader_character';

const post = (message: FromWorker, transfer: Transferable[] = []): void => self.postMessage(message, {transfer});

const poseMessage = (pose: Pose): object => ({
  rootPosition: {x: pose.root[0], y: pose.root[1], z: pose.root[2]},
  rotations: pose.rotations.map(([w, x, y, z]) => ({w, x, y, z})),
});

class Session {
  private readonly socket: WebSocket;
  private frames: Frames | undefined;
  private shader: ShaderCharacter | null = null;
  private taken = Promise.resolve();  // messages are taken one after the other
  private received = 0n;
  private ended = false;
  private wanted: ShowPose | undefined;  // before the session is open

  constructor(private readonly options: OpenSession) {
    this.socket = new WebSocket(options.url);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => void this.begin();
    this.socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      this.taken = this.taken.then(() => this.take(event.data)).catch((error: unknown) =>
        this.end('INTERNAL', error instanceof Error ? error.message : String(error)));
    };
    this.socket.onclose = () => this.end('OFFLINE', 'The connection to the server is lost.');
  }

  show(message: ShowPose): void {
    if (!this.frames) {
      this.wanted = message;
      return;
    }
    const [pose, ...history] = message.poses.map(poseMessage);
    this.send({case: 'pose', value: {
      number: BigInt(message.number), pose, history, restart: history.length === 0,
      keyframe: this.frames.needsKeyFrame, framesReceived: this.received,
    }});
  }
  close(): void {
    this.ended = true;
    this.socket.close();
  }

  private async begin(): Promise<void> {
    const {look, token, modelId} = this.options;
    this.socket.send(JSON.stringify({token}));
    this.shader = await characterFor(modelId, token, this.options.frames);
    // Parameters carry no strengths: the shader has them.
    const strengths = this.shader ? {} : {detailStrengths: [...look.jointStrengths], vertexStrengths: [...look.vertexStrengths]};
    this.send({case: 'start', value: {
      character: {modelId, skinnedOnly: look.skinnedOnly, boneScales: [...look.boneScales], ...strengths},
      options: this.shader ? {content: StreamContent.PARAMETERS} : {encoding: FrameEncoding.DRACO_DELTA}, latestWins: true, maxInFlight: this.options.maxInFlight,
    }});
  }
  private send(part: object): void {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    const request = create(LiveSessionRequestSchema, {part} as Parameters<typeof create<typeof LiveSessionRequestSchema>>[1]);
    this.socket.send(toBinary(LiveSessionRequestSchema, request));
  }

  private async take(data: string | ArrayBuffer): Promise<void> {
    if (typeof data === 'string') {
      const {code, message} = JSON.parse(data) as {code: string; message: string};
      this.end(code, message);
      return;
    }
    const response = fromBinary(LiveSessionResponseSchema, new Uint8Array(data));
    if (response.part.case === 'header') return this.open(response.part.value);
    ++this.received;
    if (response.part.case === 'frame') await this.frame(response.part.value, response.report, data.byteLength);
    if (response.part.case === 'rejection') {
      const {number, message} = response.part.value;
      post({kind: 'refused', session: this.options.session, number: Number(number), message});
    }
    this.send({case: 'acknowledgement', value: {framesReceived: this.received}});
  }

  private open(header: StreamHeader): void {
    this.frames = this.shader ? new ParameterFrames(this.shader, this.options.look) : new MeshFrames(header);
    const {numVertices, triangles, gridStep} = this.frames;
    post({kind: 'ready', session: this.options.session, numVertices, triangles, gridStep});
    if (this.wanted) this.show(this.wanted);
    this.wanted = undefined;
  }

  private async frame(frame: Frame, report: LiveReport | undefined, bytes: number): Promise<void> {
    const start = performance.now();
    const positions = await this.frames!.decode(frame);
    if (!positions || this.ended) return;
    const normals = computeNormals(positions, this.frames!.triangles);
    post({kind: 'frame', session: this.options.session, number: Number(frame.number), positions, normals,
      confidence: frame.confidence, bytes, evaluateUs: report?.evaluateUs ?? 0,
      encodeUs: report?.encodeUs ?? 0, queueUs: report?.queueUs ?? 0, decodeUs: 1e3 * (performance.now() - start)},
    [positions.buffer, normals.buffer]);
  }

  private end(code: string, message: string): void {
    if (this.ended) return;
    this.ended = true;
    this.socket.close();
    post({kind: 'ended', session: this.options.session, code, message});
  }
}

const sessions = new Map<number, Session>();
const waiting: ToWorker[] = [];
let loaded = false;

function handle(message: ToWorker): void {
  if (message.kind === 'open') {
    sessions.set(message.session, new Session(message));
  } else if (message.kind === 'show') {
    sessions.get(message.session)?.show(message);
  } else {
    sessions.get(message.session)?.close();
    sessions.delete(message.session);
  }
}

self.onmessage = (event: MessageEvent<ToWorker>) => {
  if (loaded) handle(event.data);
  else waiting.push(event.data);
};
loadDraco().then(() => {
  loaded = true;
  waiting.splice(0).forEach(handle);
}, (error: Error) => {
  for (const message of waiting) {
    if (message.kind === 'open') post({kind: 'ended', session: message.session, code: 'INTERNAL', message: error.message});
  }
});
