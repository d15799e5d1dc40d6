// Paints a normal map for a drawing with an exported model: onnxruntime-web and a canvas, nothing else.

import * as ort from "onnxruntime-web/wasm";

ort.env.wasm.numThreads = 1; // more threads need a server that sends COOP and COEP headers

// A session with the side of the square pictures that its model takes.
export async function loadModel(address) {
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(`There is no model at ${address}.`);
  const session = await ort.InferenceSession.create(new Uint8Array(await answer.arrayBuffer()));
  return Object.assign(session, { size: session.inputMetadata[0].shape[3] });
}

// size × size numbers, row by row from the top: ink 1, paper 0. The object should fill the frame.
export async function readSketch(address, size) {
  const picture = new Image();
  picture.src = address;
  await picture.decode().catch(() => {
    throw new Error("This is no picture that the browser can read.");
  });
  const context = new OffscreenCanvas(size, size).getContext("2d", { willReadFrequently: true });
  context.fillStyle = "white"; // under a transparent drawing
  context.fillRect(0, 0, size, size);
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, 0, 0, size, size);
  const { data } = context.getImageData(0, 0, size, size);
  return Float32Array.from({ length: size * size }, (_, pixel) => {
    const [red, green, blue] = data.subarray(4 * pixel, 4 * pixel + 3);
    return 1 - (0.299 * red + 0.587 * green + 0.114 * blue) / 255;
  });
}

// 3 × size × size numbers: all x (right), then all y (up), then all z (to the viewer).
export async function predict(session, sketch) {
  const { size } = session;
  // Hints: the three planes of the normals at the hinted pixels, then one that is 1 where they are.
  // Here: the middle looks at the viewer.
  const hints = new Float32Array(4 * size * size);
  const middle = (size >> 1) * size + (size >> 1);
  hints[2 * size * size + middle] = 1;
  hints[3 * size * size + middle] = 1;
  const { normal } = await session.run({
    sketch: new ort.Tensor("float32", sketch, [1, 1, size, size]),
    hints: new ort.Tensor("float32", hints, [1, 4, size, size]),
  });
  return normal.data;
}

function show(canvas, count, colourOf) {
  const size = Math.sqrt(count);
  const pixels = new Uint8ClampedArray(4 * count).fill(255);
  for (let pixel = 0; pixel < count; pixel++) pixels.set(colourOf(pixel), 4 * pixel);
  [canvas.width, canvas.height] = [size, size];
  canvas.getContext("2d").putImageData(new ImageData(pixels, size), 0, 0);
}

export function showSketch(canvas, sketch) {
  show(canvas, sketch.length, (pixel) => Array(3).fill(255 * (1 - sketch[pixel])));
}

// OpenGL's green, y up. Turn it over (255 - green) where a program wants DirectX's.
export function showNormals(canvas, normals) {
  const count = normals.length / 3;
  show(canvas, count, (pixel) => {
    const normal = [normals[pixel], normals[pixel + count], normals[pixel + 2 * count]];
    const length = Math.hypot(...normal);
    if (length <= 0.5) return [128, 128, 255]; // off the object: flat, as engines want it
    return normal.map((value) => ((value / length + 1) / 2) * 255);
  });
}
