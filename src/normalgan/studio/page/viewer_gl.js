/** Draws the views by WebGL 2. */

import { CHECKER, fitted, inverted, placeOf } from "./viewer_fit.js";
import { PAINT_UNIT, createProgram, createTexture, setLamps } from "./viewer_program.js";
import { createRelief } from "./viewer_relief.js";
import { FLAT_FRAGMENTS, FLAT_VERTEX } from "./viewer_shaders.js";
import { MATCAP_SIZE, matcapPixels } from "./viewer_shading.js";

const MAP_UNIT = 0;
const BALL_UNIT = 1;

/** Returns a copy of RGBA bytes whose colours are multiplied by their alpha. @param {Uint8Array} rgba */
function premultiplied(rgba) {
  const copy = new Uint8Array(rgba);
  const pixels = new Uint32Array(copy.buffer);
  for (let pixel = 0; pixel < pixels.length; pixel++) {
    const alpha = copy[4 * pixel + 3];
    if (alpha === 255) continue;
    if (alpha === 0) {
      pixels[pixel] = 0; // nearly all that are not opaque
      continue;
    }
    for (let k = 4 * pixel; k < 4 * pixel + 3; k++) copy[k] = Math.round((copy[k] * alpha) / 255);
  }
  return copy;
}

/**
 * Returns a painter; throws an Error if the shaders do not compile.
 * @param {HTMLCanvasElement} canvas
 * @param {WebGL2RenderingContext} gl its context
 * @returns {import("./viewer.js").ScenePainter}
 */
export function createGlPainter(canvas, gl) {
  /** @param {keyof typeof FLAT_FRAGMENTS} view */
  const shown = (view) => createProgram(gl, FLAT_VERTEX, FLAT_FRAGMENTS[view]);
  const flat = { map: shown("map"), lit: shown("lit"), matcap: shown("matcap"), flat: shown("flat") };
  const relief = createRelief(gl, MAP_UNIT);
  const nothing = gl.createVertexArray(); // the triangle comes from gl_VertexID
  const map = createTexture(gl, MAP_UNIT, gl.LINEAR_MIPMAP_LINEAR);
  const ball = createTexture(gl, BALL_UNIT, gl.LINEAR);
  const paints = createTexture(gl, PAINT_UNIT, gl.LINEAR_MIPMAP_LINEAR);
  let ballLight = "";
  gl.disable(gl.DITHER);
  gl.clearColor(0, 0, 0, 0);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);

  /** @param {number} unit @param {number} width @param {number} height @param {Uint8Array} pixels */
  function upload(unit, width, height, pixels) {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  }

  /** @param {import("./viewer.js").Picture | null} picture */
  function setMap(picture) {
    const { rgba, width, height } = picture ?? { rgba: new Uint8Array(4), width: 1, height: 1 };
    upload(MAP_UNIT, width, height, premultiplied(rgba));
    gl.generateMipmap(gl.TEXTURE_2D);
  }

  /** @param {import("./viewer.js").Picture | null} picture */
  function setColours(picture) {
    const { rgba, width, height } = picture ?? { rgba: new Uint8Array(4), width: 1, height: 1 };
    upload(PAINT_UNIT, width, height, premultiplied(rgba));
    gl.generateMipmap(gl.TEXTURE_2D);
  }

  /** @param {number[]} light */
  function makeBall(light) {
    if (ballLight === light.join()) return;
    upload(BALL_UNIT, MATCAP_SIZE, MATCAP_SIZE, new Uint8Array(matcapPixels(light).buffer));
    ballLight = light.join();
  }

  /** @param {import("./viewer.js").Picture} picture @param {import("./viewer.js").Scene} scene */
  function drawFlat(picture, scene) {
    if (scene.view === "relief") return;
    const place = placeOf(scene, picture, canvas);
    if (scene.view === "matcap") makeBall(scene.light);
    gl.disable(gl.DEPTH_TEST);
    const { program, at } = flat[scene.view];
    gl.useProgram(program);
    // What a view does not have, is null here, and ignored.
    gl.uniform1i(at.map, MAP_UNIT);
    gl.uniform1i(at.ball, BALL_UNIT);
    gl.uniform3fv(at.light, scene.light);
    setLamps(gl, at, scene);
    gl.uniform3f(at.checker, CHECKER.side * scene.ratio, Math.round(place[4]), Math.round(place[5]));
    gl.uniformMatrix3fv(at.way, false, inverted(place));
    gl.uniform1f(at.height, canvas.height);
    gl.uniform1f(at.rim, scene.tiled ? 1 : 0);
    for (const unit of [MAP_UNIT, PAINT_UNIT]) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, scene.pixelated ? gl.NEAREST : gl.LINEAR);
    }
    gl.bindVertexArray(nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /** @param {import("./viewer.js").Scene} scene */
  function draw(scene) {
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (scene.view === "relief") {
      if (scene.heights) relief.draw(scene, fitted(scene.heights, canvas), canvas);
    } else if (scene.map) {
      drawFlat(scene.map, scene);
    }
  }

  function dispose() {
    relief.dispose();
    for (const { program } of Object.values(flat)) gl.deleteProgram(program);
    gl.deleteVertexArray(nothing);
    gl.deleteTexture(map);
    gl.deleteTexture(ball);
    gl.deleteTexture(paints);
  }

  setMap(null);
  setColours(null);
  return { setMap, setColours, setHeight: relief.setHeight, draw, dispose };
}
