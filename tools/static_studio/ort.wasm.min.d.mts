// What is used of onnxruntime-web; the file itself comes from npm when the site is built.
export declare const env: { wasm: { numThreads: number; wasmPaths: string; wasmBinary?: ArrayBuffer } };
export declare class Tensor {
  constructor(type: "float32", data: Float32Array, dims: number[]);
  readonly data: Float32Array;
}
export declare class InferenceSession {
  static create(model: Uint8Array, options: object): Promise<InferenceSession>;
  readonly inputMetadata: { shape: (number | string)[] }[];
  run(feeds: Record<string, Tensor>): Promise<Record<string, Tensor>>;
}
