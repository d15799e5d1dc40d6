/** Compiles pairs of shaders and finds their uniforms by name; creates textures. */

/** @param {WebGL2RenderingContext} gl @param {number} kind @param {string} source */
function compiled(gl, kind, source) {
  const shader = /** @type {WebGLShader} */ (gl.createShader(kind)); // null only on a lost context, where it does not matter
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  return shader;
}

/**
 * Returns a program with the locations of its uniforms; throws an Error with the driver's message if it does not link.
 * @param {WebGL2RenderingContext} gl
 * @param {string} vertexSource
 * @param {string} fragmentSource
 * @returns {{program: WebGLProgram, at: Record<string, WebGLUniformLocation | null>}}
 */
export function createProgram(gl, vertexSource, fragmentSource) {
  const shaders = [
    compiled(gl, gl.VERTEX_SHADER, vertexSource),
    compiled(gl, gl.FRAGMENT_SHADER, fragmentSource),
  ];
  const program = gl.createProgram();
  for (const shader of shaders) gl.attachShader(program, shader);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    const log = [gl.getProgramInfoLog(program), ...shaders.map((shader) => gl.getShaderInfoLog(shader))];
    throw new Error(log.filter(Boolean).join(" ").trim());
  }
  for (const shader of shaders) gl.deleteShader(shader); // the program keeps what it needs
  /** @type {Record<string, WebGLUniformLocation | null>} */
  const at = {};
  const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) ?? 0; // null on a lost context
  for (let i = 0; i < count; i++) {
    const name = gl.getActiveUniform(program, i)?.name;
    if (name) at[name] = gl.getUniformLocation(program, name);
  }
  return { program, at };
}

/**
 * Returns a texture, smooth at any size and without repetition, bound to its unit permanently.
 * @param {WebGL2RenderingContext} gl
 * @param {number} unit
 * @param {number} minFilter
 * @returns {WebGLTexture}
 */
export function createTexture(gl, unit, minFilter) {
  const texture = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, minFilter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return texture;
}

/** The texture unit for the drawing's colours. */
export const PAINT_UNIT = 2;

/**
 * Sets the colours of the lights, and the direction of the second one.
 * @param {WebGL2RenderingContext} gl
 * @param {Record<string, WebGLUniformLocation | null>} at
 * @param {import("./viewer.js").Scene} scene
 */
export function setLamps(gl, at, { light, colour, second, falloff, colours }) {
  gl.uniform1f(at.falloff, falloff);
  gl.uniform1f(at.painted, colours ? 1 : 0);
  gl.uniform1i(at.paints, PAINT_UNIT);
  gl.uniform3fv(at.second, second?.direction ?? light);
  gl.uniform3fv(at["lamps[0]"], [...colour, ...(second?.colour ?? [0, 0, 0])]);
}
