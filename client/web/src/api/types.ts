// What the server's JSON holds (the mapping of Protocol Buffers: int64 are strings).
export interface Rate { numerator: number; denominator: number }
export interface Sequence {
  id: string; name: string; numFrames: number; numVertices: number; numFaces: number;
  frameRate: Rate; sizeBytes: string; created?: string;
}
export interface CompressedSequence extends Sequence { record?: {maxErrorMm: number; kgPercent: number; bpvf: number; sequenceId: string} }
export interface Note { severity: 'note' | 'warning'; kind: string; text: string; frame?: number }
export interface StoredTake {
  sequence: Sequence; notes: Note[]; faults: string[]; closed: boolean; numComponents: number; diagonalM: number;
}
export type JobState = 'JOB_STATE_QUEUED' | 'JOB_STATE_RUNNING' | 'JOB_STATE_SUCCEEDED' | 'JOB_STATE_FAILED'
  | 'JOB_STATE_CANCELLED';
export interface Job {
  id: string; state: JobState; sequenceIds: string[]; name: string; stage: string; fraction: number;
  objective?: number; etaSeconds?: number; warnings: string[]; error?: {code: number; message: string};
  resultId: string; training?: Record<string, unknown>; compression?: Record<string, unknown>;
  created?: string; started?: string; ended?: string;
}
export interface Vector { x: number; y: number; z: number }
export interface JsonJoint { name: string; parent: number; restPosition: Vector }
export interface ErrorSummary { meanPercent: number; rmsPercent: number; p95Percent: number; maxPercent: number; meanMm: number }
export interface Model {
  id: string; name: string; skeleton: {joints: JsonJoint[]}; frameRate: Rate; numVertices: number; numFaces: number;
  numControlVertices: number; numComponents: number; sizeBytes: string; created?: string; pinned: boolean;
  options: {history?: number};
  record: {
    learner: string; numFrames: number; restFrame: number; diagonalM: number; fit?: ErrorSummary;
    reconstruction?: ErrorSummary; warnings: string[];
    worstFrames: {clip: number; frame: number; meanPercent: number}[]; jointFitPercent: number[];
  };
}
// shared: the ids of what callers without a token see, or nothing.
export interface About { shared: string[]; version: string; formats: string[]; maxUploadBytes: number; maxVertices: number; maxFrames: number }
// docs/formats/motion.md
export interface MotionFile {
  schema: 'pleat.motion/1'; fps: number; joints: string[];
  frames: {root_translation: number[]; rotations: number[][]}[]; clip_starts?: number[];
  bone_scales?: Record<string, number>; detail_strengths?: Record<string, number>; vertex_strengths?: number[];
}

export const fpsOf = (rate: Rate): number => rate.numerator / rate.denominator;
export const isFinal = (state: JobState): boolean => state !== 'JOB_STATE_QUEUED' && state !== 'JOB_STATE_RUNNING';
