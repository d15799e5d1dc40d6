/** The viewer's GLSL; its numbers come from viewer_shading.js, which computes the same shading on the CPU. */

import { CEL, CLAY, FADE } from "./viewer_shading.js";

/** @param {number} value */
const number = (value) => (Number.isInteger(value) ? `${value}.0` : `${value}`);
/** @param {number[]} values */
const vec = (values) => `vec3(${values.map(number).join(", ")})`;

const CLAY_SHADING = `
vec3 srgb(vec3 linear) {
  vec3 clipped = clamp(linear, 0.0, 1.0);
  vec3 bent = 1.055 * pow(max(clipped, 1e-6), vec3(1.0 / 2.4)) - 0.055;
  return mix(bent, 12.92 * clipped, vec3(lessThanEqual(clipped, vec3(0.0031308))));
}

uniform vec3 second; // another light
uniform vec3 lamps[2]; // their colours, linear; black is off
uniform float falloff;
uniform float painted; // 1 where the surface has the drawing's colours, 0 where it is clay
uniform sampler2D paints; // those colours, premultiplied

vec3 linear_of(vec3 level) {
  return mix(pow((level + 0.055) / 1.055, vec3(2.4)), level / 12.92, vec3(lessThanEqual(level, vec3(0.04045))));
}

// Linear colour of the surface at a share of the map.
vec3 base_at(vec2 at) {
  if (painted < 0.5) return ${vec(CLAY.colour)};
  vec4 paint = texture(paints, at);
  return linear_of(paint.rgb + 1.0 - paint.a);
}

// How much comes from a lamp over a place, from the map's middle in halves of its longer side.
float dimming(vec2 place, vec3 light) {
  vec2 away = place - light.xy;
  return 1.0 / (1.0 + ${number(FADE * FADE)} * falloff * falloff * dot(away, away));
}

// Linear colour of a surface under one lamp.
vec3 lamplit(vec3 n, vec3 light, vec3 lamp, vec3 base) {
  vec3 halfway = normalize(light + vec3(0.0, 0.0, 1.000001));
  float lambert = max(dot(n, light), 0.0);
  float glint = pow(max(dot(n, halfway), 1e-6), ${number(CLAY.sharpness)}) * min(4.0 * lambert, 1.0);
  return (base * lambert + ${number(CLAY.gloss)} * glint) * ${vec(CLAY.lamp)} * lamp;
}

// And under the sky.
vec3 clay(vec3 n, vec3 light, vec3 base, vec2 place) {
  float up = (n.y + 1.0) / 2.0;
  vec3 around = base * (up * ${vec(CLAY.sky)} + (1.0 - up) * ${vec(CLAY.ground)});
  vec3 first = lamplit(n, light, lamps[0], base) * dimming(place, light);
  return around + first + lamplit(n, second, lamps[1], base) * dimming(place, second);
}

// A share of the map as dimming takes it.
vec2 place_of(vec2 at, sampler2D map) {
  vec2 size = vec2(textureSize(map, 0));
  return (2.0 * at - 1.0) * vec2(1.0, -1.0) * size / max(size.x, size.y);
}`;

const CEL_SHADING = `
float step_at(float edge, float value, float soft) { return smoothstep(edge - soft, edge + soft, value); }

// sRGB paints, side by side.
vec3 cel(vec3 n, vec3 light) {
  float soft = ${number(CEL.soft)};
  vec3 halfway = normalize(light + vec3(0.0, 0.0, 1.000001));
  float lambert = dot(n, light);
  float lit = step_at(${number(CEL.thresholds[0])}, lambert, soft);
  float bright = step_at(${number(CEL.thresholds[1])}, lambert, soft);
  float glint = step_at(${number(CEL.glint)}, dot(n, halfway), soft / 8.0);
  vec3 paint = mix(${vec(CEL.paints[0])}, ${vec(CEL.paints[1])}, lit);
  return mix(mix(paint, ${vec(CEL.paints[2])}, bright), ${vec(CEL.paints[3])}, glint);
}`;

/** One triangle over the whole canvas. */
export const FLAT_VERTEX = `#version 300 es
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  gl_Position = vec4(corner, 0.0, 1.0);
}`;

/** The inputs of a fragment in a flat view: the place in the map that it shows. */
const FLAT_HEAD = `#version 300 es
precision highp float;
precision highp int;
uniform sampler2D map;
uniform mat3 way; // from pixels of the canvas, downwards, to shares of the map
uniform float height; // of the canvas
uniform float rim; // how many maps lie on each side of the middle one, all alike
out vec4 colour;`;
const FLAT_PLACE = `
  vec2 pixel = vec2(gl_FragCoord.x, height - gl_FragCoord.y);
  vec2 at = (way * vec3(pixel, 1.0)).xy;
  vec2 across = dFdx(at), down = dFdy(at);
  if (at != clamp(at, -rim, 1.0 + rim)) { colour = vec4(0.0); return; }
  if (rim > 0.0) at = fract(at);
  vec4 texel = textureGrad(map, at, across, down);`;

const MAP_FRAGMENT = `${FLAT_HEAD}
uniform vec3 checker; // side of a cell in pixels, then the map's upper left corner
void main() {${FLAT_PLACE}
  vec2 cell = floor((pixel - checker.yz) / checker.x);
  float grey = mod(cell.x + cell.y, 2.0) * ${number(0.25)} * (1.0 - texel.a);
  colour = vec4(texel.rgb + 0.5 * grey, texel.a + grey);
}`;

/** @param {string} shading GLSL with `vec3 shaded(vec3 n, vec2 at)`, the sRGB colour of a normal at a share of the map */
const shadedFragment = (shading) => `${FLAT_HEAD}
${shading}
void main() {${FLAT_PLACE}
  float alpha = texel.a; // as soft as the outline's ink
  if (alpha < 0.002) { colour = vec4(0.0); return; }
  vec3 n = normalize(texel.rgb / texel.a * 2.0 - 1.0);
  colour = vec4(shaded(n, at) * alpha, alpha);
}`;

/**
 * The fragment shader of each flat view. The map is premultiplied, so that filtering mixes no background into the rim.
 *
 * Each view has its own shader: without a graphics card, every branch of a shader is computed for every pixel, and the
 * map alone needs hardly any computation.
 */
export const FLAT_FRAGMENTS = {
  map: MAP_FRAGMENT,
  lit: shadedFragment(`${CLAY_SHADING}
uniform vec3 light;
vec3 shaded(vec3 n, vec2 at) { return srgb(clay(n, light, base_at(at), place_of(at, map))); }`),
  matcap: shadedFragment(`
uniform sampler2D ball;
vec3 shaded(vec3 n, vec2 at) {
  vec2 place = n.z < 0.0 ? normalize(n.xy) : n.xy;
  return texture(ball, (place + 1.0) / 2.0).rgb;
}`),
  flat: shadedFragment(`${CEL_SHADING}
uniform vec3 light;
vec3 shaded(vec3 n, vec2 at) { return cel(n, light); }`),
};

/** The relief: a unit is half the longer side of the drawing, and the viewer is `eye` units in front of it. */
export const RELIEF_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 place;
layout(location = 1) in vec2 texture_place;
uniform mat3 turn;
uniform vec2 scale;
uniform float eye;
out vec2 at;
void main() {
  vec3 turned = turn * place;
  at = texture_place;
  float away = eye - turned.z;
  gl_Position = vec4(turned.xy * scale * eye, (away - eye) / 4.0 * away, away);
}`;

/** Clay lit according to the map's normals, which turn with the relief. */
export const RELIEF_FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D map;
uniform mat3 turn;
uniform vec3 light;
in vec2 at;
out vec4 colour;
${CLAY_SHADING}
void main() {
  vec4 texel = texture(map, at);
  vec3 n = texel.a < 0.002 ? vec3(0.0, 0.0, 1.0) : normalize(texel.rgb / texel.a * 2.0 - 1.0);
  vec3 turned = turn * n;
  // From behind, the inside of the shell is visible: darker, so that nobody mistakes it for the front.
  vec3 shaded = gl_FrontFacing ? clay(turned, light, base_at(at), place_of(at, map)) : 0.35 * clay(-turned, light, base_at(at), place_of(at, map));
  colour = vec4(srgb(shaded), 1.0);
}`;
