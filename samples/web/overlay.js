// SPDX-License-Identifier: Apache-2.0
// Draws the picture and its overlay by WebGL: a metre grid on the ground, the path walked, marks. Points are in the
// world n (north, east, down); the lens is applied to each vertex.
const LENS = `
attribute vec3 point; attribute vec4 tint; varying vec4 colour;
uniform vec4 q; uniform vec3 p; uniform vec4 lens; uniform vec2 size; uniform vec4 k, k2; uniform vec2 model; uniform vec4 place; uniform float dot_size;
vec3 turn(vec4 q, vec3 v) { vec3 t = 2.0 * cross(q.yzw, v); return v + q.x * t + cross(q.yzw, t); }
void main() {
  vec3 c = turn(vec4(q.x, -q.yzw), point - p);
  vec2 n = c.xy / max(c.z, 0.05), d = n;
  float r2 = dot(n, n);
  if (c.z > 0.05 && r2 < 4.0) {
    if (model.x > 1.5) { float r = sqrt(r2), t = atan(r), t2 = t * t; if (r > 1e-6) d = n * t * (1.0 + t2 * (k.x + t2 * (k.y + t2 * (k.z + t2 * k.w)))) / r; }
    else if (model.y > 0.5) d = n * (1.0 + r2 * (k.x + r2 * (k.y + r2 * k2.x))) / (1.0 + r2 * (k2.y + r2 * (k2.z + r2 * k2.w)))
      + vec2(2.0 * k.z * n.x * n.y + k.w * (r2 + 2.0 * n.x * n.x), k.z * (r2 + 2.0 * n.y * n.y) + 2.0 * k.w * n.x * n.y);
  }
  vec2 pixel = (lens.xy * (c.z > 0.05 ? d * c.z : c.xy) + (lens.zw + 0.5) * c.z) / size; // times c.z: clips what reaches behind the phone
  vec2 at = vec2(2.0 * pixel.x - c.z, c.z - 2.0 * pixel.y) * place.xy + place.zw * c.z;
  gl_Position = vec4(at, c.z - 0.1, c.z);
  gl_PointSize = dot_size / max(c.z, 0.5);
  colour = tint * vec4(1.0, 1.0, 1.0, clamp(1.6 - 0.06 * c.z, 0.12, 1.0));
}`;
const PLAIN = 'precision mediump float; varying vec4 colour; void main() { gl_FragColor = vec4(colour.rgb * colour.a, colour.a); }';
const IMAGE_AT = 'attribute vec2 corner; varying vec2 at; uniform vec4 place; void main() { at = vec2(corner.x * 0.5 + 0.5, 0.5 - corner.y * 0.5); gl_Position = vec4(corner * place.xy + place.zw, 0.0, 1.0); }';
const IMAGE = 'precision mediump float; varying vec2 at; uniform sampler2D image; void main() { gl_FragColor = vec4(texture2D(image, at).rgb, 1.0); }';

const GRID_M = 12; // to each side of the phone
const GRID_STEP_M = 1, GRID_PIECE_M = 0.5; // in pieces, so that a distorting lens bends the line
const NEAR_PATH_M = 0.35; // the path within this distance is not drawn

export class Overlay {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = this.gl = canvas.getContext('webgl', {antialias: true, premultipliedAlpha: true, preserveDrawingBuffer: true});
    if (!gl) throw new Error('This browser has no WebGL, which the picture needs.');
    this.lines = this.#program(LENS, PLAIN);
    this.image = this.#program(IMAGE_AT, IMAGE);
    this.buffer = gl.createBuffer();
    this.square = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.square);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    for (const [name, value] of [[gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE], [gl.TEXTURE_MIN_FILTER, gl.LINEAR]]) gl.texParameteri(gl.TEXTURE_2D, name, value);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  #program(vertex, fragment) {
    const {gl} = this, program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    return program;
  }

  /** Placement of the picture in canvas coordinates from -1 to 1: it fills the canvas and is cropped. */
  place(width, height) {
    const {canvas} = this, ratio = (canvas.width / canvas.height) / (width / height);
    return ratio > 1 ? [1, ratio, 0, 0] : [1 / ratio, 1, 0, 0];
  }

  /** Pixel of the picture at a canvas position in CSS pixels from the upper left corner, and the inverse. */
  pixelAt([x, y], camera) {
    const [sx, sy] = this.place(camera.width, camera.height), {clientWidth, clientHeight} = this.canvas;
    return [((2 * x / clientWidth - 1) / sx + 1) / 2 * camera.width - 0.5, ((2 * y / clientHeight - 1) / sy + 1) / 2 * camera.height - 0.5];
  }
  placeOf([u, v], camera) {
    const [sx, sy] = this.place(camera.width, camera.height), {clientWidth, clientHeight} = this.canvas;
    return [((2 * (u + 0.5) / camera.width - 1) * sx + 1) / 2 * clientWidth, ((2 * (v + 0.5) / camera.height - 1) * sy + 1) / 2 * clientHeight];
  }

  /** `view`: {bitmap, camera, pose, path, ground, marks}; null items are not drawn. */
  draw({bitmap, camera, pose, path, ground, marks}) {
    const {gl, canvas} = this, dense = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(canvas.clientWidth * dense), height = Math.round(canvas.clientHeight * dense);
    if (canvas.width !== width || canvas.height !== height) canvas.width = width, canvas.height = height;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (!bitmap) return;
    const place = this.place(bitmap.width, bitmap.height);
    gl.useProgram(this.image);
    gl.uniform4fv(gl.getUniformLocation(this.image, 'place'), place);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.square);
    const corner = gl.getAttribLocation(this.image, 'corner');
    gl.enableVertexAttribArray(corner);
    gl.vertexAttribPointer(corner, 2, gl.FLOAT, false, 0, 0);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.disableVertexAttribArray(corner);
    if (!camera || !pose) return;
    this.#use(camera, pose, place, height);
    if (ground !== null) this.#put(gl.LINES, grid(pose.p_n, ground));
    if (ground !== null && path.length > 1) this.#put(gl.TRIANGLES, ribbon(path, pose.p_n, ground));
    if (marks.length) this.#put(gl.LINES, marks.flatMap(mark => post(mark, ground)));
    if (marks.length) this.#put(gl.POINTS, marks.flatMap(({p_n}) => [...p_n, 1, 0.72, 0.1, 1]));
  }

  #use(camera, pose, place, height) {
    const {gl, lines} = this, at = name => gl.getUniformLocation(lines, name), k = camera.distortion;
    gl.useProgram(lines);
    gl.uniform4fv(at('q'), pose.q_n);
    gl.uniform3fv(at('p'), pose.p_n);
    gl.uniform4f(at('lens'), camera.fx, camera.fy, camera.cx, camera.cy);
    gl.uniform2f(at('size'), camera.width, camera.height);
    gl.uniform4f(at('k'), k[0], k[1], k[2], k[3]);
    gl.uniform4f(at('k2'), k[4], k[5], k[6], k[7]);
    gl.uniform2f(at('model'), camera.model, camera.distortion_count);
    gl.uniform4fv(at('place'), place);
    gl.uniform1f(at('dot_size'), 0.06 * height);
  }

  #put(mode, numbers) {
    const {gl, lines} = this, point = gl.getAttribLocation(lines, 'point'), tint = gl.getAttribLocation(lines, 'tint');
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STREAM_DRAW);
    gl.enableVertexAttribArray(point);
    gl.enableVertexAttribArray(tint);
    gl.vertexAttribPointer(point, 3, gl.FLOAT, false, 28, 0);
    gl.vertexAttribPointer(tint, 4, gl.FLOAT, false, 28, 12);
    gl.drawArrays(mode, 0, numbers.length / 7);
  }
}

function grid([north, east], ground) {
  const out = [], n0 = Math.round(north), e0 = Math.round(east);
  for (let i = -GRID_M; i <= GRID_M; i += GRID_STEP_M)
    for (let j = -GRID_M; j < GRID_M; j += GRID_PIECE_M) {
      const strong = (offset, origin) => (origin + offset) % 5 === 0 ? 0.8 : 0.42;
      const one = [1, 1, 1, strong(i, n0)], other = [1, 1, 1, strong(i, e0)];
      out.push(n0 + i, e0 + j, ground, ...one, n0 + i, e0 + j + GRID_PIECE_M, ground, ...one);
      out.push(n0 + j, e0 + i, ground, ...other, n0 + j + GRID_PIECE_M, e0 + i, ground, ...other);
    }
  return out;
}

/** The path on the ground, 20 cm wide; narrower lines are invisible at a phone's resolution. */
function ribbon(path, here, ground) {
  const out = [], half_m = 0.1, tint = [0.25, 0.72, 1, 0.85];
  for (let i = 1; i < path.length; ++i) {
    const a = path[i - 1], b = path[i], dn = b[0] - a[0], de = b[1] - a[1], far = Math.hypot(dn, de);
    if (far < 1e-6 || Math.hypot(b[0] - here[0], b[1] - here[1]) < NEAR_PATH_M) continue;
    const n = -de / far * half_m, e = dn / far * half_m;
    const corner = (p, side) => [p[0] + side * n, p[1] + side * e, ground, ...tint];
    out.push(...corner(a, 1), ...corner(a, -1), ...corner(b, 1), ...corner(b, 1), ...corner(a, -1), ...corner(b, -1));
  }
  return out;
}

function post({p_n}, ground) {
  if (ground === null) return [];
  const tint = [1, 0.72, 0.1, 0.9];
  return [...p_n, ...tint, p_n[0], p_n[1], ground, ...tint];
}
