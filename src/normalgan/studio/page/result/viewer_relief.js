/** Draws the surface of the heights in perspective, lit according to the map's normals. */

import { meshOf } from "./viewer_mesh.js";
import { createProgram, setLamps } from "./viewer_program.js";
import { RELIEF_FRAGMENT, RELIEF_VERTEX } from "./viewer_shaders.js";

const EYE = 6; // distance of the viewer, in halves of the drawing's longer side
const ROOM = 0.85; // share of the canvas that an unturned relief fills: a turned one needs more

/**
 * Returns a rotation, column by column: about y (the front goes to the right), then about x (it goes down).
 * @param {{yaw: number, pitch: number}} turn radians
 * @returns {number[]}
 */
function turnMatrix({ yaw, pitch }) {
  const [ca, sa, cb, sb] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return [ca, sb * sa, -cb * sa, 0, cb, sb, sa, -sb * ca, cb * ca];
}

/** Draws a relief. */
export class Relief {
  #count = 0;

  /**
   * @param {WebGL2RenderingContext} gl
   * @param {number} mapUnit the texture unit that holds the map
   */
  constructor(gl, mapUnit) {
    this.gl = gl;
    this.mapUnit = mapUnit;
    this.program = createProgram(gl, RELIEF_VERTEX, RELIEF_FRAGMENT);
    this.array = gl.createVertexArray();
    this.buffers = { places: gl.createBuffer(), wheres: gl.createBuffer(), corners: gl.createBuffer() };
    const { places, wheres, corners } = this.buffers;
    gl.bindVertexArray(this.array);
    for (const { location, buffer, channels } of [
      { location: 0, buffer: places, channels: 3 },
      { location: 1, buffer: wheres, channels: 2 },
    ]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, channels, gl.FLOAT, false, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, corners);
    gl.bindVertexArray(null);
  }

  /** @param {import("./viewer.js").Heights | null} heights */
  setHeight(heights) {
    const { gl, buffers } = this;
    const mesh = meshOf(heights ?? { heights: new Float32Array(), width: 0, height: 0 });
    this.#count = mesh.corners.length;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers.places);
    gl.bufferData(gl.ARRAY_BUFFER, mesh.places, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers.wheres);
    gl.bufferData(gl.ARRAY_BUFFER, mesh.wheres, gl.STATIC_DRAW);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.corners, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
  }

  /**
   * @param {import("./viewer.js").Scene} scene
   * @param {{width: number, height: number}} place the place of the drawing on the canvas, seen from the front
   * @param {{width: number, height: number}} canvas
   */
  draw(scene, place, canvas) {
    const { gl, program: { program, at } } = this;
    const size = ROOM * scene.turn.zoom * Math.max(place.width, place.height);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(program);
    gl.uniform1i(at.map, this.mapUnit);
    gl.uniformMatrix3fv(at.turn, false, turnMatrix(scene.turn));
    gl.uniform2f(at.scale, size / canvas.width, size / canvas.height);
    gl.uniform1f(at.eye, EYE);
    gl.uniform3fv(at.light, scene.light);
    setLamps(gl, at, scene);
    gl.bindVertexArray(this.array);
    gl.drawElements(gl.TRIANGLES, this.#count, gl.UNSIGNED_INT, 0);
  }

  dispose() {
    const { gl } = this;
    gl.deleteProgram(this.program.program);
    gl.deleteVertexArray(this.array);
    for (const buffer of Object.values(this.buffers)) gl.deleteBuffer(buffer);
  }
}
