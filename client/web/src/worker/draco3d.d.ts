// The part of draco3d that the page uses.
declare module 'draco3d/draco_decoder_nodejs.js' {
  export interface Status { ok(): boolean; error_msg(): string }
  export interface PointCloud { num_points(): number; num_faces(): number; num_attributes(): number }
  export interface Attribute { data_type(): number }
  export interface Buffer { Init(bytes: Int8Array, size: number): void }
  export interface Decoder {
    DecodeBufferToMesh(buffer: Buffer, mesh: PointCloud): Status;
    DecodeBufferToPointCloud(buffer: Buffer, cloud: PointCloud): Status;
    GetAttribute(geometry: PointCloud, index: number): Attribute;
    GetAttributeId(geometry: PointCloud, type: number): number;
    GetAttributeDataArrayForAllPoints(geometry: PointCloud, attribute: Attribute, type: number, bytes: number, pointer: number): boolean;
    GetTrianglesUInt32Array(mesh: PointCloud, bytes: number, pointer: number): boolean;
  }
  export interface DecoderModule {
    DecoderBuffer: new () => Buffer;
    Decoder: new () => Decoder;
    Mesh: new () => PointCloud;
    PointCloud: new () => PointCloud;
    POSITION: number; GENERIC: number; DT_FLOAT32: number; DT_INT32: number;
    HEAPU8: Uint8Array;
    _malloc(bytes: number): number;
    _free(pointer: number): void;
    destroy(object: object): void;
  }
  export default function createDecoder(options: {wasmBinary: ArrayBuffer}): Promise<DecoderModule>;
}
