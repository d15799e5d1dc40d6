/** Draws the views with WebGL 2. */

import { CHECKER, fitted, inverted, placeOf } from "./viewer_fit.js";
import { PAINT_UNIT, createProgram, createTexture, setLamps } from "./viewer_program.js";
import { Relief } from "./viewer_relief.js";
import { FLAT_FRAGMENTS, FLAT_VERTEX } from "./viewer_shaders.js";
import { MATCAP_SIZE, matcapPixels } from "./viewer_shading.js";

const MAP_UNIT = 0;
const BALL_UNIT = 1;

/** Returns a copy of RGBA bytes with premultiplied alpha. @param {Uint8Array} rgba */
function premultiplied(rgba) {
  const copy = new Uint8Array(rgba);
  const pixels = new Uint32Array(copy.buffer);
  for (let pixel = 0; pixel < pixels.length; pixel++) {
    const alpha = copy[4 * pixel + 3];
    if (alpha === 255) continue;
    if (alpha === 0) {
      pixels[pixel] = 0; // nearly all pixels that are not opaque
      continue;
    }
    for (let k = 4 * pixel; k < 4 * pixel + 3; k++) copy[k] = Math.round((copy[k] * alpha) / 255);
  }
  return copy;
}

/** @typedef {"map" | "lit" | "matcap" | "flat"} FlatView */

/** Draws scenes with WebGL. */
export class GlPainter {
  /** The light of the ball in the matcap's texture. */
  #ballLight = "";

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {WebGL2RenderingContext} gl its context
   * @throws {Error} if the shaders do not compile
   */
  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    /** @param {FlatView} view */
    const shown = (view) => createProgram(gl, FLAT_VERTEX, FLAT_FRAGMENTS[view]);
    this.programs = { map: shown("map"), lit: shown("lit"), matcap: shown("matcap"), flat: shown("flat") };
    this.relief = new Relief(gl, MAP_UNIT);
    this.nothing = gl.createVertexArray(); // the triangle comes from gl_VertexID
    this.textures = [
      createTexture(gl, MAP_UNIT, gl.LINEAR_MIPMAP_LINEAR),
      createTexture(gl, BALL_UNIT, gl.LINEAR),
      createTexture(gl, PAINT_UNIT, gl.LINEAR_MIPMAP_LINEAR),
    ];
    gl.disable(gl.DITHER);
    gl.clearColor(0, 0, 0, 0);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    this.setMap(null);
    this.setColours(null);
  }

  /** @param {import("./viewer.js").Picture | null} map */
  setMap(map) {
    this.#setPicture(MAP_UNIT, map);
  }

  /** @param {import("./viewer.js").Picture | null} colours */
  setColours(colours) {
    this.#setPicture(PAINT_UNIT, colours);
  }

  /** @param {import("./viewer.js").Heights | null} heights */
  setHeight(heights) {
    this.relief.setHeight(heights);
  }

  /** @param {import("./viewer.js").Scene} scene */
  draw(scene) {
    const { gl, canvas } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (scene.view === "relief") {
      if (scene.heights) this.relief.draw(scene, fitted(scene.heights, canvas), canvas);
    } else if (scene.map) {
      this.#drawFlat(scene.view, scene.map, scene);
    }
  }

  dispose() {
    const { gl } = this;
    this.relief.dispose();
    for (const { program } of Object.values(this.programs)) gl.deleteProgram(program);
    gl.deleteVertexArray(this.nothing);
    for (const texture of this.textures) gl.deleteTexture(texture);
  }

  /** @param {FlatView} view @param {import("./viewer.js").Picture} map @param {import("./viewer.js").Scene} scene */
  #drawFlat(view, map, scene) {
    const { gl, canvas } = this;
    const place = placeOf(scene, map, canvas);
    if (view === "matcap") this.#makeBall(scene.light);
    gl.disable(gl.DEPTH_TEST);
    const { program, at } = this.programs[view];
    gl.useProgram(program);
    // A uniform that a view lacks is null here, and ignored.
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
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /** @param {number[]} light */
  #makeBall(light) {
    if (this.#ballLight === light.join()) return;
    this.#upload(BALL_UNIT, MATCAP_SIZE, MATCAP_SIZE, new Uint8Array(matcapPixels(light).buffer));
    this.#ballLight = light.join();
  }

  /** @param {number} unit @param {import("./viewer.js").Picture | null} picture */
  #setPicture(unit, picture) {
    const { rgba, width, height } = picture ?? { rgba: new Uint8Array(4), width: 1, height: 1 };
    this.#upload(unit, width, height, premultiplied(rgba));
    this.gl.generateMipmap(this.gl.TEXTURE_2D);
  }

  /** @param {number} unit @param {number} width @param {number} height @param {Uint8Array} pixels */
  #upload(unit, width, height, pixels) {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  }
}
