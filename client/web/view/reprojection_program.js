// What WebGL 2 holds for reprojection.js: the frame as a texture and its depth as a mesh, and the program that draws the one
// on the other. Everything is made once and filled anew with each frame.

import { depthMesh } from './depth_mesh.js';
import { gridOf, squareIndices } from './mesh_triangles.js';

const vertexShader = `#version 300 es
in vec2 place;
in float nearness;
in vec2 texel;
uniform mat4 toClip;
uniform vec2 backdrop;
uniform float deepest;
out vec2 at;
void main() {
  at = texel;
  if (nearness <= 0.0) gl_Position = vec4(place * backdrop, 0.99999, 1.0);
  else if (deepest > 0.0) gl_Position = toClip * vec4(place, deepest - nearness, 1.0);
  else gl_Position = toClip * vec4(place, 1.0, nearness);
}`;

const fragmentShader = `#version 300 es
precision highp float;
in vec2 at;
uniform sampler2D frame;
out vec4 color;
void main() {
  color = vec4(texture(frame, at).rgb, 1.0);
}`;

const float = 4; // bytes
const indexBytes = 4;
const layers = [0, 0.95, 0.97]; // depth of what is behind edges (its own), of bridges, of the backdrop

/** Where nothing is known of depth: a plane. */
const plane = (distance) => ({ width: 2, height: 2, inverse: new Float32Array(4).fill(1 / distance) });

function compiled(gl, type, source) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  return shader;
}

function linked(gl) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
    const shader = compiled(gl, type, source);
    gl.attachShader(program, shader);
    gl.deleteShader(shader); // with the program
  }
  ['place', 'nearness', 'texel'].forEach((name, index) => gl.bindAttribLocation(program, index, name));
  gl.linkProgram(program);
  return gl.getProgramParameter(program, gl.LINK_STATUS) ? program : undefined;
}

export class ReprojectionProgram {
  #gl;
  #uniforms;
  #mesh; // { array, grid, nearness, indices, count }: what the frame shows; `count` of indices
  #filling; // { array, vertices, indices, counts }: what is made up where it shows nothing
  #indexed = 0; // squares that the filling's indices are good for
  #shape = ''; // of the grid
  #textureSize = '';
  #deepest = 0;

  /** The depths that there are in the frame. */
  depths = { least: 1, greatest: 1 };

  /** Undefined where the graphics driver takes no program. */
  static create(gl) {
    const program = linked(gl);
    return program ? new ReprojectionProgram(gl, program) : undefined;
  }

  constructor(gl, program) {
    this.#gl = gl;
    gl.useProgram(program);
    this.#uniforms = Object.fromEntries(['toClip', 'backdrop', 'deepest'].map((name) => [name, gl.getUniformLocation(program, name)]));
    gl.enable(gl.DEPTH_TEST);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    for (const [name, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.MIRRORED_REPEAT], [gl.TEXTURE_WRAP_T, gl.MIRRORED_REPEAT],
    ]) gl.texParameteri(gl.TEXTURE_2D, name, value);
    const made = () => ({ array: gl.createVertexArray(), indices: gl.createBuffer() });
    this.#mesh = { ...made(), count: 0, grid: gl.createBuffer(), nearness: gl.createBuffer() };
    this.#filling = { ...made(), counts: [], vertices: gl.createBuffer() };
    const attribute = (index, size, stride, offset) => {
      gl.enableVertexAttribArray(index);
      gl.vertexAttribPointer(index, size, gl.FLOAT, false, stride * float, offset * float);
    };
    gl.bindVertexArray(this.#mesh.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.#mesh.indices);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#mesh.grid);
    attribute(0, 2, 4, 0);
    attribute(2, 2, 4, 2);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#mesh.nearness);
    attribute(1, 1, 1, 0);
    gl.bindVertexArray(this.#filling.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.#filling.indices);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#filling.vertices);
    attribute(0, 2, 5, 0);
    attribute(1, 1, 5, 2);
    attribute(2, 2, 5, 3);
  }

  /** From here on it draws this frame: `bitmap`, `depth` if there is any, and the `pose` that it was drawn from. */
  load({ bitmap, depth, pose }) {
    const gl = this.#gl;
    const mesh = depthMesh(depth ?? plane(pose.distance), pose.orthographic);
    this.depths = mesh.depths;
    this.#deepest = mesh.deepest;
    const shape = `${mesh.columns} ${mesh.rows}`;
    if (shape !== this.#shape) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.#mesh.grid);
      gl.bufferData(gl.ARRAY_BUFFER, gridOf(mesh.columns, mesh.rows), gl.STATIC_DRAW);
      this.#shape = shape;
    }
    gl.bindVertexArray(this.#mesh.array); // to which the element buffer belongs
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#mesh.nearness);
    gl.bufferData(gl.ARRAY_BUFFER, mesh.nearness, gl.DYNAMIC_DRAW);
    this.#mesh.count = mesh.triangles.length;
    const { squares: vertices, behind, across, backdrop } = mesh.filling;
    const squares = behind + across + backdrop;
    if (squares > this.#indexed) {
      gl.bindVertexArray(this.#filling.array);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, squareIndices(squares), gl.STATIC_DRAW);
      this.#indexed = squares;
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#filling.vertices);
    gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.DYNAMIC_DRAW);
    this.#filling.counts = [behind, across, backdrop].map((count) => 6 * count);
    const size = `${bitmap.width} ${bitmap.height}`;
    if (size === this.#textureSize) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    else gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    this.#textureSize = size;
  }

  /** `toClip`, `backdrop`: pose.js. Where nothing is drawn the canvas stays transparent. */
  draw(toClip, backdrop) {
    const gl = this.#gl;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.#uniforms.toClip, false, toClip);
    gl.uniform2fv(this.#uniforms.backdrop, backdrop);
    gl.uniform1f(this.#uniforms.deepest, this.#deepest);
    gl.bindVertexArray(this.#mesh.array);
    gl.depthRange(0, 0.9);
    if (this.#mesh.count > 0) gl.drawElements(gl.TRIANGLES, this.#mesh.count, gl.UNSIGNED_INT, 0);
    // Each of these only where nothing is yet, but that what is behind edges takes part in the mesh's own order.
    gl.bindVertexArray(this.#filling.array);
    let first = 0;
    this.#filling.counts.forEach((count, i) => {
      if (i > 0) gl.depthRange(layers[i], layers[i]);
      if (count > 0) gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, first * indexBytes);
      first += count;
    });
  }
}
