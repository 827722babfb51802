// What the page and its worker tell each other.
import type {Pose} from '../math/skeleton';
import type {Look} from '../store/motion';

// auto: parameters where the machine shows them fast, meshes elsewhere.
export type FramesChoice = 'auto' | 'mesh' | 'parameters';
export interface OpenSession {
  frames: FramesChoice;
  kind: 'open'; session: number; modelId: string; look: Look; token: string; url: string; maxInFlight: number;
}
// poses[0] is shown, poses[h] is the pose h training-frame intervals earlier.
export interface ShowPose { kind: 'show'; session: number; number: number; poses: Pose[] }
export interface CloseSession { kind: 'close'; session: number }
export type ToWorker = OpenSession | ShowPose | CloseSession;

export interface SessionReady {
  kind: 'ready'; session: number; numVertices: number; triangles: Uint32Array; gridStep: number;
}
export interface FrameArrived {
  kind: 'frame'; session: number; number: number; positions: Float32Array; normals: Float32Array;
  confidence: number; bytes: number; evaluateUs: number; encodeUs: number; queueUs: number; decodeUs: number;
}
export interface PoseRefused { kind: 'refused'; session: number; number: number; message: string }
export interface SessionEnded { kind: 'ended'; session: number; code: string; message: string }
export type FromWorker = SessionReady | FrameArrived | PoseRefused | SessionEnded;
