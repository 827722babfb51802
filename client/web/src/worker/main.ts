// The worker of the page: it holds the live sessions, decodes their frames and computes normals, so
// that the page's own thread only draws.
import {create, fromBinary, toBinary} from '@bufbuild/protobuf';
import {FrameEncoding, LiveSessionRequestSchema, LiveSessionResponseSchema, type Frame, type LiveReport,
  type StreamHeader} from '../generated/pleat/v1/pose_service_pb';
import type {Pose} from '../math/skeleton';
import {DeltaDecoder, type Box} from './delta';
import {decodeCloud, decodeResiduals, decodeTopology, loadDraco} from './draco';
import type {FromWorker, OpenSession, ShowPose, ToWorker} from './messages';
import {computeNormals} from './normals';

const post = (message: FromWorker, transfer: Transferable[] = []): void => self.postMessage(message, {transfer});

const poseMessage = (pose: Pose): object => ({
  rootPosition: {x: pose.root[0], y: pose.root[1], z: pose.root[2]},
  rotations: pose.rotations.map(([w, x, y, z]) => ({w, x, y, z})),
});

class Session {
  private readonly socket: WebSocket;
  private decoder: DeltaDecoder | undefined;
  private triangles = new Uint32Array();
  private order = new Int32Array();
  private received = 0n;
  private ended = false;
  private wanted: ShowPose | undefined;  // before the session is open

  constructor(private readonly options: OpenSession) {
    this.socket = new WebSocket(options.url);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => this.begin();
    this.socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      try {
        this.take(event.data);
      } catch (error) {
        this.end('INTERNAL', error instanceof Error ? error.message : String(error));
      }
    };
    this.socket.onclose = () => this.end('OFFLINE', 'The connection to the server is lost.');
  }

  show(message: ShowPose): void {
    if (!this.decoder) {
      this.wanted = message;
      return;
    }
    const [pose, ...history] = message.poses.map(poseMessage);
    this.send({case: 'pose', value: {
      number: BigInt(message.number), pose, history, restart: history.length === 0,
      keyframe: this.decoder.needsKeyFrame, framesReceived: this.received,
    }});
  }
  close(): void {
    this.ended = true;
    this.socket.close();
  }

  private begin(): void {
    this.socket.send(JSON.stringify({token: this.options.token}));
    this.send({case: 'start', value: {
      character: {modelId: this.options.modelId, skinnedOnly: this.options.skinnedOnly},
      options: {encoding: FrameEncoding.DRACO_DELTA}, latestWins: true, maxInFlight: this.options.maxInFlight,
    }});
  }
  private send(part: object): void {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    const request = create(LiveSessionRequestSchema, {part} as Parameters<typeof create<typeof LiveSessionRequestSchema>>[1]);
    this.socket.send(toBinary(LiveSessionRequestSchema, request));
  }

  private take(data: string | ArrayBuffer): void {
    if (typeof data === 'string') {
      const {code, message} = JSON.parse(data) as {code: string; message: string};
      this.end(code, message);
      return;
    }
    const response = fromBinary(LiveSessionResponseSchema, new Uint8Array(data));
    if (response.part.case === 'header') return this.open(response.part.value);
    ++this.received;
    if (response.part.case === 'frame') this.frame(response.part.value, response.report);
    if (response.part.case === 'rejection') {
      const {number, message} = response.part.value;
      post({kind: 'refused', session: this.options.session, number: Number(number), message});
    }
    this.send({case: 'acknowledgement', value: {framesReceived: this.received}});
  }

  private open(header: StreamHeader): void {
    const {originX, originY, originZ, range, bits} = header.box!;
    const box: Box = {origin: [originX, originY, originZ], step: range / (2 ** bits - 1)};
    const topology = decodeTopology(header.topologyDraco, header.numVertices);
    this.triangles = topology.triangles as Uint32Array<ArrayBuffer>;
    this.order = Int32Array.from(header.vertexOrder);
    this.decoder = new DeltaDecoder(topology.triangles, topology.positions, box);
    post({kind: 'ready', session: this.options.session, numVertices: header.numVertices,
      triangles: topology.triangles, gridStep: box.step});
    if (this.wanted) this.show(this.wanted);
    this.wanted = undefined;
  }

  private frame(frame: Frame, report: LiveReport | undefined): void {
    const start = performance.now();
    const decoder = this.decoder!;
    const good = frame.difference ? decoder.addResiduals(decodeResiduals(frame.draco), frame.checksum)
      : decoder.setKeyFrame(this.inVertexOrder(decodeCloud(frame.draco)), frame.checksum);
    if (!good) return;  // the next pose asks for a key frame
    const positions = decoder.positions();
    const normals = computeNormals(positions, this.triangles);
    post({kind: 'frame', session: this.options.session, number: Number(frame.number), positions, normals,
      confidence: frame.confidence, bytes: frame.draco.length, evaluateUs: report?.evaluateUs ?? 0,
      encodeUs: report?.encodeUs ?? 0, queueUs: report?.queueUs ?? 0, decodeUs: 1e3 * (performance.now() - start)},
    [positions.buffer, normals.buffer]);
  }
  private inVertexOrder(points: Float32Array): Float32Array {
    const positions = new Float32Array(points.length);
    for (let k = 0; k < this.order.length; ++k) {
      for (let c = 0; c < 3; ++c) positions[3 * this.order[k]! + c] = points[3 * k + c]!;
    }
    return positions;
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
