// Programs of the WebGL picture. Colours are mixed in linear light.

const SOLID_VERTEX = `#version 300 es
in vec3 position; in vec3 normal; in float tint;
uniform mat4 viewProjection, model;
out vec3 place; out vec3 direction; out float pattern;
void main() {
  vec4 world = model * vec4(position, 1.0);
  place = world.xyz;
  direction = mat3(model) * normal;
  pattern = tint;
  gl_Position = viewProjection * world;
}`;

const SOLID_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place; in vec3 direction; in float pattern;
uniform vec3 base, mark, eye, light, background;
uniform float fade, floorHeight, size;
out vec4 result;
vec3 linear(vec3 c) { return pow(c, vec3(2.2)); }
void main() {
  vec3 n = normalize(direction);
  vec3 v = normalize(eye - place);
  vec3 surface = linear(mix(base, mark, pattern));
  float sky = 0.5 + 0.5 * n.z;
  // Less of the sky is seen close to the floor.
  float open = mix(0.55, 1.0, clamp((place.z - floorHeight) / (0.15 * size), 0.0, 1.0));
  vec3 ambient = mix(vec3(0.20, 0.19, 0.18), vec3(0.50, 0.53, 0.58), sky) * mix(open, 1.0, max(n.z, 0.0));
  float sun = max(dot(n, light), 0.0);
  float glint = pow(max(dot(n, normalize(light + v)), 0.0), 60.0);
  float rim = pow(1.0 - max(dot(n, v), 0.0), 4.0);
  vec3 lit = surface * (ambient + 0.78 * sun) + 0.22 * glint + 0.06 * rim;
  result = vec4(mix(pow(lit, vec3(1.0 / 2.2)), background, fade), 1.0);
}`;

const FLOOR_VERTEX = `#version 300 es
in vec3 position;
uniform mat4 viewProjection, model;
out vec3 place;
void main() {
  vec4 world = model * vec4(position, 1.0);
  place = world.xyz;
  gl_Position = viewProjection * world;
}`;

const FLOOR_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place;
uniform vec3 background, ground, lines, target;
uniform float spacing, major, reach;
out vec4 result;
float grid(float step, float width) {
  vec2 at = place.xy / step;
  vec2 far = abs(fract(at - 0.5) - 0.5) / fwidth(at);
  return 1.0 - smoothstep(width - 0.5, width + 0.5, min(far.x, far.y));
}
void main() {
  float near = 1.0 - smoothstep(0.35 * reach, reach, distance(place.xy, target.xy));
  // Lines closer than some pixels become grey.
  vec2 pixels = spacing / fwidth(place.xy);
  float fine = smoothstep(3.0, 12.0, min(pixels.x, pixels.y));
  float ink = max(0.45 * fine * grid(spacing, 0.6), 0.8 * grid(major, 0.9));
  vec3 surface = mix(ground, lines, ink);
  result = vec4(mix(background, surface, near), 1.0);
}`;

const FLAT_VERTEX = `#version 300 es
in vec3 position;
uniform mat4 viewProjection, model;
void main() { gl_Position = viewProjection * (model * vec4(position, 1.0)); }`;

const FLAT_FRAGMENT = `#version 300 es
precision mediump float;
uniform vec4 paint;
out vec4 result;
void main() { result = vec4(paint.rgb * paint.a, paint.a); }`;
