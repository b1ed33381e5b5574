'use strict';
// The replay of a plan: kinematics of the trees, a small renderer (WebGL 2, or a plain canvas where there is none), a
// clock, and the hands on it. Matrices are arrays of 16 numbers, column after column.
(() => {
  const by = id => document.getElementById(id);
  const root = document.documentElement;

  by('theme').addEventListener('click', () => {
    const chosen = root.dataset.theme || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
    root.dataset.theme = chosen === 'dark' ? 'light' : 'dark';
    root.dispatchEvent(new Event('themechange'));
  });
  if (!by('scene')) { by('replay').hidden = true; return; }

  // --- Numbers ------------------------------------------------------------------------------------------------------

  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
  const scene = JSON.parse(by('scene').textContent);
  const times = new Float64Array(bytes(scene.times));
  for (const arm of scene.arms) {
    arm.positions = new Float32Array(bytes(arm.positions));
    arm.errors = new Float64Array(bytes(arm.errors));
    arm.strays = new Float32Array(bytes(arm.strays));
  }
  const last = times.length - 1;
  const duration = last > 0 ? times[last] - times[0] : 0;

  // --- Matrices -----------------------------------------------------------------------------------------------------

  const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const product = (a, b) => {
    const c = new Array(16);
    for (let column = 0; column < 4; column++) for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      c[4 * column + row] = sum;
    }
    return c;
  };
  const fromRows = r => [r[0], r[4], r[8], 0, r[1], r[5], r[9], 0, r[2], r[6], r[10], 0, r[3], r[7], r[11], 1];
  const shift = v => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, v[0], v[1], v[2], 1];
  const scaling = (x, y, z) => [x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1];
  const turn = ([x, y, z], angle) => {
    const s = Math.sin(angle), c = Math.cos(angle), k = 1 - c;
    return [c + x * x * k, y * x * k + z * s, z * x * k - y * s, 0, x * y * k - z * s, c + y * y * k, z * y * k + x * s, 0,
      x * z * k + y * s, y * z * k - x * s, c + z * z * k, 0, 0, 0, 0, 1];
  };
  const add = (a, b, k = 1) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const length = v => Math.hypot(v[0], v[1], v[2]);
  const unit = v => { const l = length(v) || 1; return [v[0] / l, v[1] / l, v[2] / l]; };
  const place = m => [m[12], m[13], m[14]];
  const axisOf = (m, v) => [m[0] * v[0] + m[4] * v[1] + m[8] * v[2], m[1] * v[0] + m[5] * v[1] + m[9] * v[2], m[2] * v[0] + m[6] * v[1] + m[10] * v[2]];
  const moved = (m, v) => add(axisOf(m, v), place(m));
  // The frame whose z points along `axis`, at `at`, scaled.
  const along = (at, axis, wide, long) => {
    const z = unit(axis), x = unit(cross(Math.abs(z[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0], z)), y = cross(z, x);
    return [...x.map(v => v * wide), 0, ...y.map(v => v * wide), 0, ...z.map(v => v * long), 0, ...at, 1];
  };

  // --- Kinematics ---------------------------------------------------------------------------------------------------

  for (const machine of scene.machines) {
    machine.world = fromRows(machine.world);
    for (const joint of machine.joints) joint.origin = fromRows(joint.origin);
  }
  const displacement = (joint, q) => joint.kind === 'turn' ? turn(joint.axis, q)
    : joint.kind === 'slide' ? shift(joint.axis.map(a => a * q)) : IDENTITY;
  const linkPoses = (machine, q) => {
    const poses = new Array(machine.links).fill(machine.world);
    machine.joints.forEach((joint, i) => {
      const position = joint.mimic ? joint.mimic[1] * q[joint.mimic[0]] + joint.mimic[2] : q[i];
      poses[joint.child] = product(product(poses[joint.parent], joint.origin), displacement(joint, position));
    });
    return poses;
  };
  // The frame before a time, and how far on to the next one.
  const frameAt = time => {
    let low = 0, high = Math.max(last, 0);
    while (high - low > 1) { const middle = (low + high) >> 1; if (times[middle] <= time) low = middle; else high = middle; }
    const gap = times[low + 1] - times[low];
    return { frame: low, part: gap > 0 ? Math.min(Math.max((time - times[low]) / gap, 0), 1) : 0 };
  };
  const posesAt = time => {
    const { frame, part } = frameAt(time);
    return scene.machines.map((machine, index) => {
      const q = machine.rest.slice();
      if (last >= 0) for (const arm of scene.arms) if (arm.machine === index) arm.joints.forEach((joint, k) => {
        const n = arm.joints.length, now = arm.positions[frame * n + k], next = arm.positions[Math.min(frame + 1, last) * n + k];
        q[joint] = now + part * (next - now);
      });
      return linkPoses(machine, q);
    });
  };
  // Paths of the tips, and the paths asked for: what is not finite is left out.
  for (const arm of scene.arms) { arm.path = []; arm.asked = []; }
  for (let frame = 0; frame <= last; frame++) {
    const poses = posesAt(times[frame]);
    for (const arm of scene.arms) {
      const tip = place(poses[arm.machine][arm.tip]);
      arm.path.push(...tip);
      if (arm.strays.length) arm.asked.push(tip[0] - arm.strays[3 * frame], tip[1] - arm.strays[3 * frame + 1], tip[2] - arm.strays[3 * frame + 2]);
    }
  }

  // --- Where everything is ------------------------------------------------------------------------------------------

  const bounds = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
  const include = p => { if (p.every(Number.isFinite)) for (let k = 0; k < 3; k++) {
    bounds.low[k] = Math.min(bounds.low[k], p[k]); bounds.high[k] = Math.max(bounds.high[k], p[k]); } };
  for (let i = 0; i <= 24; i++) for (const poses of posesAt((times[0] || 0) + duration * i / 24)) for (const pose of poses) include(place(pose));
  for (const arm of scene.arms) for (let i = 0; i < arm.path.length; i += 3) include(arm.path.slice(i, i + 3));
  if (!(bounds.low[0] <= bounds.high[0])) { bounds.low = [-1, -1, -1]; bounds.high = [1, 1, 1]; }
  const extent = bounds.high.map((high, k) => high - bounds.low[k]);
  const size = Math.max(...extent, 1e-3);
  const middle = bounds.low.map((low, k) => low + extent[k] / 2);
  const isFlat = extent[2] < 0.02 * size;

  // --- Meshes: corners with normals ---------------------------------------------------------------------------------

  // A body of revolution about z through [radius, height] points; where these have a normal as well, it is round there.
  const lathe = (profile, sides) => {
    const corners = [], normals = [], places = [];
    for (let ring = 0; ring + 1 < profile.length; ring++) {
      const ends = [profile[ring], profile[ring + 1]], [[r0, z0], [r1, z1]] = ends;
      const slope = Math.hypot(r1 - r0, z1 - z0) || 1;
      const begin = corners.length / 3;
      for (let i = 0; i <= sides; i++) for (const [r, z, outward = (z1 - z0) / slope, upward = (r0 - r1) / slope] of ends) {
        // The last corner is the first to the bit: the seam has no gap.
        const a = 2 * Math.PI * (i % sides) / sides, c = Math.cos(a), s = Math.sin(a);
        corners.push(r * c, r * s, z);
        normals.push(outward * c, outward * s, upward);
      }
      for (let i = 0; i < sides; i++) { const a = begin + 2 * i; places.push(a, a + 2, a + 1, a + 1, a + 2, a + 3); }
    }
    return { corners: new Float32Array(corners), normals: new Float32Array(normals), places: new Uint32Array(places) };
  };
  const arc = (from, to, steps, lift) => Array.from({ length: steps + 1 }, (_, i) => {
    const a = from + (to - from) * i / steps;
    return [Math.cos(a), lift + Math.sin(a), Math.cos(a), Math.sin(a)];
  });
  const cube = () => {
    const corners = [], normals = [], places = [];
    for (const axis of [0, 1, 2]) for (const side of [-1, 1]) {
      const begin = corners.length / 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const p = [0, 0, 0], n = [0, 0, 0];
        p[axis] = side / 2; p[u] = a / 2; p[v] = b / 2; n[axis] = side;
        corners.push(...p); normals.push(...n);
      }
      places.push(...(side > 0 ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2]).map(k => begin + k));
    }
    return { corners: new Float32Array(corners), normals: new Float32Array(normals), places: new Uint32Array(places) };
  };
  // Corners of a mesh get the mean normal of the faces around them that are nearly in one plane with their own.
  const withNormals = (points, triangles) => {
    const CREASE = Math.cos(0.7), faces = triangles.length / 3, area = [], around = Array.from({ length: points.length / 3 }, () => []);
    const point = i => points.subarray(3 * i, 3 * i + 3);
    for (let f = 0; f < faces; f++) {
      const [a, b, c] = [0, 1, 2].map(k => point(triangles[3 * f + k]));
      area.push(cross(add(b, a, -1), add(c, a, -1)));
      for (let k = 0; k < 3; k++) around[triangles[3 * f + k]].push(f);
    }
    const flat = area.map(unit), corners = new Float32Array(9 * faces), normals = new Float32Array(9 * faces);
    for (let i = 0; i < 3 * faces; i++) {
      const own = flat[Math.floor(i / 3)];
      let sum = [0, 0, 0];
      for (const f of around[triangles[i]]) if (dot(own, flat[f]) > CREASE) sum = add(sum, area[f]);
      corners.set(point(triangles[i]), 3 * i);
      normals.set(unit(sum), 3 * i);
    }
    return { corners, normals, places: Uint32Array.from({ length: 3 * faces }, (_, i) => i) };
  };
  const surface = ({ low, step, corners, triangles, colour }) => {
    const cells = new Uint16Array(bytes(corners)), points = new Float32Array(cells.length);
    for (let i = 0; i < cells.length; i++) points[i] = low[i % 3] + step * cells[i];
    return { mesh: withNormals(points, new Uint32Array(bytes(triangles))), colour };
  };
  const SIDES = 24;
  const shapes = {
    box: cube(),
    cylinder: lathe([[0, -0.5], [1, -0.5], [1, 0.5], [0, 0.5]], SIDES),
    sphere: lathe(arc(-Math.PI / 2, Math.PI / 2, 12, 0), SIDES),
    stick: lathe([[1, 0], [0.78, 1]], 16),
    disc: lathe([[0, -1], [0.82, -1], [1, -0.82], [1, 0.82], [0.82, 1], [0, 1]], SIDES),
  };
  const capsules = new Map();
  const capsule = (radius, long) => {
    const key = radius + ' ' + long, half = long / 2 / radius;
    if (!capsules.has(key)) capsules.set(key, lathe([...arc(-Math.PI / 2, 0, 6, -half), ...arc(0, Math.PI / 2, 6, half)], SIDES));
    return capsules.get(key);
  };
  let surfaces = null;

  // --- Colours ------------------------------------------------------------------------------------------------------

  let colours;
  const readColours = () => {
    const style = getComputedStyle(root);
    const read = name => {
      const hex = style.getPropertyValue(name).trim().replace('#', '');
      const digits = hex.length === 3 ? [...hex].map(d => d + d) : hex.match(/../g);
      return digits.slice(0, 3).map(d => parseInt(d, 16) / 255);
    };
    colours = { sky: read('--sky'), floor: read('--floor'), robot: read('--robot'), ink: read('--ink'), arms: [0, 1, 2, 3, 4, 5, 6].map(i => read('--c' + i)) };
  };
  const mix = (a, b, part) => a.map((v, k) => v + part * (b[k] - v));

  // --- What is drawn: a list of {mesh, pose, colour} ----------------------------------------------------------------

  // Of every link: whose arm it is on, or none, or several.
  const owners = scene.machines.map(machine => new Array(machine.links).fill(null));
  for (const [index, arm] of scene.arms.entries()) for (const link of arm.links) {
    const own = owners[arm.machine];
    own[link] = own[link] === null ? index : 'several';
  }
  const colourOf = owner => owner === null ? mix(colours.robot, colours.sky, 0.35) : owner === 'several' ? colours.robot : colours.arms[scene.arms[owner].colour];
  const reaches = scene.machines.map(machine => {
    const poses = linkPoses(machine, machine.rest).map(place);
    const span = k => Math.max(...poses.map(p => p[k])) - Math.min(...poses.map(p => p[k]));
    return Math.max(span(0), span(1), span(2), 1e-3);
  });
  const depths = scene.machines.map(machine => {
    const depth = new Array(machine.links).fill(0);
    for (const joint of machine.joints) depth[joint.child] = depth[joint.parent] + (joint.kind === 'fixed' ? 0 : 1);
    return depth;
  });

  const sticks = (machine, index, poses, draw) => {
    const wide = 0.026 * reaches[index], deepest = Math.max(...depths[index], 1), own = owners[index];
    const isMoving = joint => joint.kind !== 'fixed';
    const radius = link => wide * (1 - 0.5 * depths[index][link] / deepest) * (own[link] === null ? 0.5 : 1);
    const origin = place(poses[0] || machine.world);
    if (!isFlat) draw(shapes.disc, along(add(origin, axisOf(machine.world, [0, 0, 1]), 0.15 * wide), axisOf(machine.world, [0, 0, 1]), 2.2 * wide, 0.15 * wide), colours.robot);
    machine.joints.forEach(joint => {
      const from = place(poses[joint.parent]), to = place(poses[joint.child]), span = add(to, from, -1);
      // A link belongs to an arm where both of its ends do.
      const owner = own[joint.parent] === null ? null : own[joint.child];
      const ink = colourOf(owner), r = owner === null ? Math.min(radius(joint.child), 0.5 * wide) : radius(joint.child);
      if (length(span) > 1e-6 * size) draw(shapes.stick, along(from, span, r, length(span)), ink);
      draw(shapes.sphere, product(shift(to), scaling(0.78 * r, 0.78 * r, 0.78 * r)), ink);
      if (!isMoving(joint)) return;
      const axis = axisOf(poses[joint.child], joint.axis), dark = mix(ink, [0, 0, 0], 0.28);
      if (joint.kind === 'turn') draw(shapes.disc, along(to, axis, 1.5 * r, 1.25 * r), dark);
      else {
        draw(shapes.box, along(product(poses[joint.parent], joint.origin).slice(12, 15), axis, 3 * r, 3 * r), dark);
        draw(shapes.box, along(to, axis, 2.2 * r, 2.2 * r), dark);
      }
    });
  };

  const lookOf = (look, pose, owner, draw) => {
    const s = look.size, at = product(pose, look.local ||= fromRows(look.pose));
    const ink = look.colour ? look.colour.slice(0, 3) : mix(colourOf(owner), [1, 1, 1], 0.3);
    if (look.shape === 'box') draw(shapes.box, product(at, scaling(s[0], s[1], s[2])), ink);
    else if (look.shape === 'cylinder') draw(shapes.cylinder, product(at, scaling(s[0], s[0], s[1])), ink);
    else if (look.shape === 'sphere') draw(shapes.sphere, product(at, scaling(s[0], s[0], s[0])), ink);
    else if (look.shape === 'capsule') draw(capsule(s[0], s[1]), product(at, scaling(s[0], s[0], s[0])), ink);
    else {
      surfaces ||= scene.meshes.map(mesh => mesh.map(surface));
      const scaled = product(at, scaling(s[0], s[1], s[2]));
      // The URDF's colour is meant for meshes that have none.
      for (const part of surfaces[look.mesh]) draw(part.mesh, scaled, part.colour ? part.colour.slice(0, 3) : ink);
    }
  };

  let showsSticks = false;
  const hasLooks = machine => machine.looks.length > 0;
  const solids = (poses, isPlain) => {
    const list = [], draw = (mesh, pose, colour) => { if (pose.every(Number.isFinite)) list.push({ mesh, pose, colour }); };
    scene.machines.forEach((machine, index) => {
      const isMesh = look => look.shape === 'mesh';
      // A plain canvas would take seconds for meshes.
      if (!hasLooks(machine) || showsSticks || isPlain && machine.looks.some(isMesh)) sticks(machine, index, poses[index], draw);
      else {
        // Where a shape is missing, the joints show what is there.
        if (machine.lacks) sticks(machine, index, poses[index], draw);
        for (const look of machine.looks) lookOf(look, poses[index][look.link], owners[index][look.link], draw);
      }
    });
    return list;
  };

  // --- Camera -------------------------------------------------------------------------------------------------------

  const VIEWS = { 1: [-1.05, 0.42], 2: [-Math.PI / 2, Math.PI / 2], 3: [-Math.PI / 2, 0] };
  const FIELD = 0.6;
  const camera = {};
  // Far enough for the corners of what there is.
  const fit = aspect => {
    const { right, up, ahead } = axes();
    let far = 0;
    for (let i = 0; i < 8; i++) {
      const corner = [0, 1, 2].map(k => ((i >> k & 1) - 0.5) * (extent[k] + 0.12 * size));
      const room = Math.max(Math.abs(dot(corner, right)) / aspect, Math.abs(dot(corner, up)));
      far = Math.max(far, room / Math.tan(FIELD / 2) - dot(corner, ahead));
    }
    return 1.04 * far;
  };
  const axes = () => {
    const [sa, ca, se, ce] = [Math.sin(camera.turn), Math.cos(camera.turn), Math.sin(camera.lift), Math.cos(camera.lift)];
    const ahead = [-ce * ca, -ce * sa, -se], right = [-sa, ca, 0];
    return { ahead, right, up: cross(right, ahead) };
  };
  const view = number => {
    [camera.turn, camera.lift] = VIEWS[number];
    camera.target = middle.slice();
    camera.far = null;
    redraw();
  };
  const reset = () => view(isFlat ? 2 : 1);
  const projection = (width, height) => {
    const { ahead, right, up } = axes(), aspect = width / height;
    camera.far ||= fit(aspect);
    const eye = add(camera.target, ahead, -camera.far), near = 0.02 * camera.far, back = camera.far + 40 * size, f = 1 / Math.tan(FIELD / 2);
    const look = [right[0], up[0], -ahead[0], 0, right[1], up[1], -ahead[1], 0, right[2], up[2], -ahead[2], 0, -dot(right, eye), -dot(up, eye), dot(ahead, eye), 1];
    const lens = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (back + near) / (near - back), -1, 0, 0, 2 * back * near / (near - back), 0];
    return { matrix: product(lens, look), eye, right, up, ahead };
  };

  // --- Lines: lists of points, in strips or in pairs ----------------------------------------------------------------

  const floorAt = bounds.low[2] - (isFlat ? 0.02 * size : 0);
  const floor = (() => {
    const step = 10 ** Math.floor(Math.log10(size / 2)), cell = size / step > 12 ? 2 * step : step, points = [];
    const from = k => Math.floor((bounds.low[k] - 0.25 * size) / cell), to = k => Math.ceil((bounds.high[k] + 0.25 * size) / cell);
    for (let x = from(0); x <= to(0); x++) points.push(x * cell, from(1) * cell, floorAt, x * cell, to(1) * cell, floorAt);
    for (let y = from(1); y <= to(1); y++) points.push(from(0) * cell, y * cell, floorAt, to(0) * cell, y * cell, floorAt);
    return { points: new Float32Array(points), inPairs: true };
  })();
  const strip = points => ({ points: new Float32Array(points), inPairs: false });
  const lines = scene.arms.map(arm => ({ asked: strip(arm.asked), path: strip(arm.path) }));
  const tripod = (pose, long) => [0, 1, 2].map(k => ({
    line: { points: new Float32Array([...place(pose), ...moved(pose, [0, 1, 2].map(j => j === k ? long : 0))]), inPairs: true, isBrief: true },
    colour: [[0.85, 0.15, 0.15], [0.1, 0.6, 0.2], [0.15, 0.35, 0.9]][k],
  }));

  // --- Renderer: WebGL 2 --------------------------------------------------------------------------------------------

  const SOLID = [`#version 300 es
    in vec3 corner; in vec3 normal; uniform mat4 pose, lens; out vec3 across;
    void main() { across = transpose(inverse(mat3(pose))) * normal; gl_Position = lens * (pose * vec4(corner, 1.0)); }`, `#version 300 es
    precision highp float; in vec3 across; uniform vec4 ink; uniform vec3 ahead, up; out vec4 colour;
    void main() {
      vec3 n = normalize(across); if (dot(n, ahead) > 0.0) n = -n;
      float lit = 0.45 + 0.33 * max(dot(n, normalize(up - 0.55 * ahead)), 0.0) + 0.22 * max(dot(n, -ahead), 0.0) + 0.1 * n.z;
      float shine = pow(max(dot(n, normalize(0.6 * up - ahead)), 0.0), 40.0);
      colour = ink.a < 1.0 ? ink : vec4(ink.rgb * lit + 0.12 * shine, 1.0);
    }`];
  const LINE = [`#version 300 es
    in vec3 from, to; in vec2 side; uniform mat4 lens; uniform vec2 pixel; uniform float wide;
    void main() {
      vec4 a = lens * vec4(from, 1.0), b = lens * vec4(to, 1.0);
      if (a.w < 1e-4 || b.w < 1e-4) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
      vec2 along = (b.xy / b.w - a.xy / a.w) / pixel; float l = length(along);
      along = l > 1e-4 ? along / l : vec2(1.0, 0.0);
      vec4 p = side.x < 0.5 ? a : b;
      vec2 out_ = along * (side.x - 0.5) + vec2(-along.y, along.x) * side.y;
      gl_Position = vec4(p.xy + out_ * wide * pixel * p.w, p.z - 2e-4 * p.w, p.w);
    }`, `#version 300 es
    precision highp float; uniform vec4 ink; out vec4 colour; void main() { colour = ink; }`];

  const openGl = canvas => {
    const gl = canvas.getContext('webgl2', { antialias: true, alpha: false, stencil: true, preserveDrawingBuffer: true });
    if (!gl) return null;
    const program = sources => {
      const made = gl.createProgram();
      sources.forEach((source, i) => {
        const shader = gl.createShader(i ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
        gl.shaderSource(shader, source.trim()); gl.compileShader(shader); gl.attachShader(made, shader);
      });
      gl.linkProgram(made);
      if (!gl.getProgramParameter(made, gl.LINK_STATUS)) return null;
      const uniform = {};
      for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); i++) {
        const { name } = gl.getActiveUniform(made, i);
        uniform[name] = gl.getUniformLocation(made, name);
      }
      return { made, uniform, at: name => gl.getAttribLocation(made, name) };
    };
    const solid = program(SOLID), line = program(LINE);
    if (!solid || !line) return null;
    const kept = new Map();
    const upload = (kind, data) => { const buffer = gl.createBuffer(); gl.bindBuffer(kind, buffer); gl.bufferData(kind, data, gl.STATIC_DRAW); return buffer; };
    const attribute = (at, buffer, count, stride = 0, offset = 0, divisor = 0) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer); gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, count, gl.FLOAT, false, stride, offset); gl.vertexAttribDivisor(at, divisor);
    };
    const remembered = (key, make) => { if (!kept.has(key)) { const array = gl.createVertexArray(); gl.bindVertexArray(array); make(); kept.set(key, array); } return kept.get(key); };
    const quad = upload(gl.ARRAY_BUFFER, new Float32Array([0, -0.5, 1, -0.5, 0, 0.5, 1, 0.5]));
    const drawLine = (state, shape, ink, wide, count = Infinity) => {
      const stride = shape.inPairs ? 24 : 12, all = shape.inPairs ? shape.points.length / 6 : shape.points.length / 3 - 1;
      const segments = Math.min(all, count);
      if (!(segments > 0)) return;
      let buffer;
      const make = () => {
        buffer = upload(gl.ARRAY_BUFFER, shape.points);
        attribute(line.at('from'), buffer, 3, stride, 0, 1); attribute(line.at('to'), buffer, 3, stride, 12, 1); attribute(line.at('side'), quad, 2);
      };
      const array = shape.isBrief ? gl.createVertexArray() : remembered(shape, make);
      gl.bindVertexArray(array);
      if (shape.isBrief) make();
      gl.useProgram(line.made);
      gl.uniformMatrix4fv(line.uniform.lens, false, state.matrix);
      gl.uniform2f(line.uniform.pixel, 2 / canvas.width, 2 / canvas.height);
      gl.uniform1f(line.uniform.wide, wide * state.density);
      gl.uniform4f(line.uniform.ink, ...ink);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, segments);
      if (shape.isBrief) { gl.deleteVertexArray(array); gl.deleteBuffer(buffer); }
    };
    const drawSolid = ({ mesh, pose, colour }, alpha = 1) => {
      gl.bindVertexArray(remembered(mesh, () => {
        attribute(solid.at('corner'), upload(gl.ARRAY_BUFFER, mesh.corners), 3);
        attribute(solid.at('normal'), upload(gl.ARRAY_BUFFER, mesh.normals), 3);
        upload(gl.ELEMENT_ARRAY_BUFFER, mesh.places);
      }));
      gl.uniformMatrix4fv(solid.uniform.pose, false, pose);
      gl.uniform4f(solid.uniform.ink, ...colour, alpha);
      gl.drawElements(gl.TRIANGLES, mesh.places.length, gl.UNSIGNED_INT, 0);
    };
    // Light from straight above throws every body onto the floor; the stencil keeps it from darkening twice.
    const shadows = (list, above) => {
      if (!above) return;
      gl.enable(gl.STENCIL_TEST); gl.stencilFunc(gl.EQUAL, 0, 255); gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR); gl.depthMask(false);
      const flat = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1e-4, 0, 0, 0, floorAt, 1];
      for (const item of list) drawSolid({ ...item, pose: product(flat, item.pose), colour: [0, 0, 0] }, 0.13);
      gl.disable(gl.STENCIL_TEST); gl.depthMask(true);
    };
    return {
      isPlain: false,
      draw(state) {
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.clearColor(...colours.sky, 1);
        gl.enable(gl.DEPTH_TEST); gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
        // The floor is behind everything that stands on it.
        gl.depthMask(false);
        drawLine(state, floor, [...colours.floor, 0.8], 1);
        gl.depthMask(true);
        gl.useProgram(solid.made);
        gl.uniformMatrix4fv(solid.uniform.lens, false, state.matrix);
        gl.uniform3f(solid.uniform.ahead, ...state.ahead); gl.uniform3f(solid.uniform.up, ...state.up);
        shadows(state.solids, state.eye[2] > floorAt);
        for (const item of state.solids) drawSolid(item);
        gl.depthMask(false);
        for (const { shape, ink, wide, count } of state.lines) drawLine(state, shape, ink, wide, count);
        gl.depthMask(true);
      },
    };
  };

  // --- Renderer: a plain canvas, far faces first --------------------------------------------------------------------

  const openPlain = canvas => {
    const pen = canvas.getContext('2d');
    const css = (rgb, alpha = 1) => `rgba(${rgb.slice(0, 3).map(v => Math.round(255 * Math.min(Math.max(v, 0), 1))).join(',')},${alpha})`;
    const onScreen = (state, x, y, z) => {
      const m = state.matrix, w = m[3] * x + m[7] * y + m[11] * z + m[15];
      return w < 1e-3 ? null : [(m[0] * x + m[4] * y + m[8] * z + m[12]) / w * canvas.width / 2 + canvas.width / 2, canvas.height / 2 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w * canvas.height / 2, w];
    };
    const drawLine = (state, { points, inPairs }, ink, wide, count = Infinity) => {
      pen.strokeStyle = css(ink, ink[3]); pen.lineWidth = wide * state.density; pen.lineJoin = pen.lineCap = 'round'; pen.beginPath();
      const end = Math.min(points.length, inPairs ? Infinity : 3 * (count + 1));
      let isDown = false;
      for (let i = 0; i < end; i += 3) {
        const p = onScreen(state, points[i], points[i + 1], points[i + 2]);
        if (inPairs && i % 6 === 0) isDown = false;
        if (!p) { isDown = false; continue; }
        if (isDown) pen.lineTo(p[0], p[1]); else pen.moveTo(p[0], p[1]);
        isDown = true;
      }
      pen.stroke();
    };
    const faces = (state, { mesh, pose, colour }, list) => {
      const count = mesh.corners.length / 3, world = new Array(count), seen = new Array(count);
      for (let i = 0; i < count; i++) { world[i] = moved(pose, mesh.corners.subarray(3 * i, 3 * i + 3)); seen[i] = onScreen(state, ...world[i]); }
      for (let i = 0; i < mesh.places.length; i += 3) {
        const [a, b, c] = mesh.places.subarray(i, i + 3), [p, q, r] = [seen[a], seen[b], seen[c]];
        if (!p || !q || !r || (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) >= 0) continue;
        const n = unit(cross(add(world[b], world[a], -1), add(world[c], world[a], -1)));
        const lit = 0.5 + 0.4 * Math.max(dot(n, unit(add(state.up, state.ahead, -0.8))), 0) + 0.12 * n[2];
        list.push({ depth: p[2] + q[2] + r[2], p, q, r, ink: css(colour.map(v => v * lit)) });
      }
    };
    return {
      isPlain: true,
      draw(state) {
        pen.fillStyle = css(colours.sky); pen.fillRect(0, 0, canvas.width, canvas.height);
        drawLine(state, floor, [...colours.floor, 0.8], 1);
        const list = [];
        for (const item of state.solids) faces(state, item, list);
        list.sort((a, b) => b.depth - a.depth);
        for (const { p, q, r, ink } of list) {
          pen.fillStyle = pen.strokeStyle = ink; pen.lineWidth = 0.7; pen.beginPath();
          pen.moveTo(p[0], p[1]); pen.lineTo(q[0], q[1]); pen.lineTo(r[0], r[1]); pen.closePath(); pen.fill(); pen.stroke();
        }
        for (const { shape, ink, wide, count } of state.lines) drawLine(state, shape, ink, wide, count);
      },
    };
  };

  let canvas = by('view');
  let renderer;
  const open = isPlain => {
    renderer = !isPlain && openGl(canvas);
    if (renderer) return canvas.addEventListener('webglcontextlost', () => { open(true); redraw(); }, { once: true });
    // A canvas keeps the kind of drawing that it was first asked for.
    const fresh = canvas.cloneNode(false);
    canvas.replaceWith(fresh);
    canvas = fresh;
    listen();
    renderer = openPlain(canvas);
  };

  // --- The clock, and what it shows ---------------------------------------------------------------------------------

  let time = times[0] || 0, isPlaying = false, awaited = false, before = 0;
  const speeds = [0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 32, 64, 128];
  for (const speed of speeds) by('speed').append(new Option(`${speed} ×`, speed));
  by('speed').value = duration > 30 ? speeds.find(speed => speed >= duration / 30) || speeds.at(-1) : 1;
  if (duration > 0 && duration < 2) by('speed').value = speeds.filter(speed => speed <= duration / 2).at(-1) || speeds[0];

  const digits = Math.min(Math.max(0, 2 - Math.floor(Math.log10(duration || 1))), 6);
  const minus = text => text.replaceAll('-', '−');
  const cells = scene.arms.map(arm => {
    const row = by('arms').tBodies[0].insertRow(), head = document.createElement('th');
    head.scope = 'row'; head.className = `c${arm.colour}`;
    const dot = document.createElement('span'); dot.className = 'swatch';
    head.append(dot, arm.name); row.append(head);
    return [0, 1, 2, 3].map(() => row.insertCell());
  });
  const readOut = poses => {
    const end = times[last] || 0;
    by('clock').textContent = last < 0 ? 'no sample' : `${time.toFixed(digits)} s of ${end.toFixed(digits)} s`;
    by('time').setAttribute('aria-valuetext', `${time.toFixed(digits)} seconds`);
    const { frame, part } = frameAt(time);
    scene.arms.forEach((arm, i) => {
      const error = arm.errors[part > 0.5 ? frame + 1 : frame], tip = place(poses[arm.machine][arm.tip]);
      cells[i][0].textContent = error === undefined ? '–' : minus(error.toExponential(2));
      tip.forEach((value, k) => { cells[i][k + 1].textContent = minus((+value.toFixed(4) || 0).toFixed(4)); });
    });
  };

  // Figures over time have a line where the clock is, and set it where they are pressed.
  const cursors = [...document.querySelectorAll('.figure[data-time]')].map(figure => {
    const [left, right, top, bottom, from, to] = figure.dataset.time.split(' ').map(Number), svg = figure.querySelector('svg');
    const line = document.createElementNS('http://www.w3.org/2000/svg', 'line');
    line.setAttribute('class', 'cursor'); line.setAttribute('y1', top); line.setAttribute('y2', bottom);
    svg.append(line);
    svg.addEventListener('click', event => {
      const box = svg.getBoundingClientRect(), x = (event.clientX - box.left) / box.width * svg.viewBox.baseVal.width;
      if (x >= left && x <= right) seek(from + (x - left) / (right - left) * (to - from));
    });
    return () => {
      const x = left + (time - from) / (to - from) * (right - left);
      line.setAttribute('x1', x); line.setAttribute('x2', x); line.style.display = x >= left - 1 && x <= right + 1 ? '' : 'none';
    };
  });

  const draw = () => {
    const density = Math.min(devicePixelRatio || 1, 2), width = Math.max(canvas.clientWidth, 1), height = Math.max(canvas.clientHeight, 1);
    if (canvas.width !== Math.round(width * density) || canvas.height !== Math.round(height * density)) {
      canvas.width = Math.round(width * density); canvas.height = Math.round(height * density);
    }
    const poses = posesAt(time), { frame } = frameAt(time), shown = [];
    scene.arms.forEach((arm, i) => {
      const ink = colours.arms[arm.colour], tip = poses[arm.machine][arm.tip];
      shown.push({ shape: lines[i].asked, ink: [...mix(ink, colours.sky, 0.62), 1], wide: 7 });
      shown.push({ shape: lines[i].path, ink: [...mix(ink, colours.ink, 0.25), 1], wide: 2, count: frame });
      for (const { line, colour } of tripod(tip, Math.min(0.1 * reaches[arm.machine], 0.07 * size))) shown.push({ shape: line, ink: [...colour, 1], wide: 2.5 });
    });
    renderer.draw({ ...projection(width, height), density, solids: solids(poses, renderer.isPlain), lines: shown });
    for (const cursor of cursors) cursor();
    readOut(poses);
    by('time').value = time;
  };
  const step = now => {
    awaited = false;
    if (isPlaying) {
      time += Math.min((now - before) / 1000, 0.25) * by('speed').value;
      before = now;
      if (time >= times[last]) {
        if (by('loop').checked) time = times[0]; else { time = times[last]; play(false); }
      }
    }
    draw();
    if (isPlaying) redraw();
  };
  const redraw = () => { if (!awaited) { awaited = true; requestAnimationFrame(step); } };
  const seek = to => { time = Math.min(Math.max(to, times[0] || 0), times[last] || 0); redraw(); };
  const play = want => {
    isPlaying = want && duration > 0;
    if (isPlaying && time >= times[last]) time = times[0];
    before = performance.now();
    by('play').textContent = isPlaying ? '❚❚' : '▶';
    by('play').setAttribute('aria-label', isPlaying ? 'Pause' : 'Play');
    redraw();
  };
  const faster = steps => {
    const select = by('speed');
    select.selectedIndex = Math.min(Math.max(select.selectedIndex + steps, 0), speeds.length - 1);
  };
  const zoom = factor => { camera.far = Math.min(Math.max((camera.far || size) * factor, 0.05 * size), 30 * size); redraw(); };
  const toggleSticks = () => {
    showsSticks = !showsSticks;
    by('sticks').setAttribute('aria-pressed', showsSticks);
    redraw();
  };

  // --- Hands --------------------------------------------------------------------------------------------------------

  const orbit = (x, y) => {
    camera.turn -= 0.008 * x;
    camera.lift = Math.min(Math.max(camera.lift + 0.008 * y, -Math.PI / 2), Math.PI / 2);
    redraw();
  };
  const pan = (x, y) => {
    const { right, up } = axes(), scale = 2 * camera.far * Math.tan(FIELD / 2) / canvas.clientHeight;
    camera.target = add(add(camera.target, right, -x * scale), up, y * scale);
    redraw();
  };
  const fingers = new Map();
  const spread = () => { const [a, b] = [...fingers.values()]; return { apart: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 }; };
  const listen = () => {
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('pointerdown', event => {
      try { canvas.setPointerCapture(event.pointerId); } catch { /* A finger may be gone already. */ }
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      by('stage').focus({ preventScroll: true });
    });
    canvas.addEventListener('pointermove', event => {
      const finger = fingers.get(event.pointerId);
      if (!finger) return;
      const x = event.clientX - finger.x, y = event.clientY - finger.y, old = fingers.size === 2 && spread();
      finger.x = event.clientX; finger.y = event.clientY;
      if (old) { const now = spread(); pan(now.x - old.x, now.y - old.y); if (now.apart > 0) zoom(old.apart / now.apart); }
      else if (event.shiftKey || event.buttons & 6) pan(x, y);
      else orbit(x, y);
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => fingers.delete(event.pointerId));
    canvas.addEventListener('wheel', event => {
      // Until it is pressed, the page scrolls past it.
      if (!event.ctrlKey && document.activeElement !== by('stage')) return;
      event.preventDefault();
      zoom(Math.exp(0.0015 * Math.max(-200, Math.min(event.deltaY, 200))));
    }, { passive: false });
  };
  const keys = {
    ' ': () => play(!isPlaying), ArrowUp: () => faster(1), ArrowDown: () => faster(-1),
    ArrowRight: event => scrub(1, event.shiftKey), ArrowLeft: event => scrub(-1, event.shiftKey),
    '+': () => zoom(0.85), '=': () => zoom(0.85), '-': () => zoom(1 / 0.85), r: reset, s: toggleSticks, 1: () => view(1), 2: () => view(2), 3: () => view(3),
  };
  const scrub = (direction, isFine) => {
    if (last < 0) return;
    const { frame, part } = frameAt(time), at = frame + Math.round(part);
    seek(isFine ? times[Math.min(Math.max(at + direction, 0), last)] : time + direction * duration / 50);
  };
  document.addEventListener('keydown', event => {
    const target = event.target, isRange = target.id === 'time', isArrow = event.key.startsWith('Arrow');
    if (event.ctrlKey || event.altKey || event.metaKey || !(event.key in keys)) return;
    // Keys that something in focus has its own use for stay with it, and arrows scroll the page where the replay is not meant.
    if (!isRange && target.matches('input, select, textarea') || event.key === ' ' && target.matches('button, summary')) return;
    if (!by('replay').contains(target) && (isArrow || target !== document.body)) return;
    if (event.key === ' ' && target.matches('.scroll, pre')) return;
    event.preventDefault();
    keys[event.key](event);
  });

  by('play').addEventListener('click', () => play(!isPlaying));
  by('reset').addEventListener('click', reset);
  by('sticks').addEventListener('click', toggleSticks);
  by('time').addEventListener('input', () => seek(Number(by('time').value)));
  for (const button of document.querySelectorAll('[data-view]')) button.addEventListener('click', () => view(button.dataset.view));
  for (const button of document.querySelectorAll('.moment')) button.addEventListener('click', () => {
    play(false);
    seek(Number(button.dataset.time));
    by('stage').scrollIntoView({ block: 'center', behavior: matchMedia('(prefers-reduced-motion: reduce)').matches ? 'auto' : 'smooth' });
  });
  const recolour = () => { readColours(); redraw(); };
  root.addEventListener('themechange', recolour);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', recolour);
  addEventListener('resize', () => { redraw(); });
  // What is folded is printed too, but for the keys.
  const folded = document.querySelectorAll('details:not(#keys):not([open])');
  addEventListener('beforeprint', () => { for (const part of folded) part.open = true; readColours(); draw(); });
  addEventListener('afterprint', () => { for (const part of folded) part.open = false; recolour(); });

  by('time').min = times[0] || 0;
  by('time').max = times[last] || 0;
  for (const id of ['play', 'time', 'speed', 'loop']) by(id).disabled = !(duration > 0);
  by('sticks').hidden = !scene.machines.some(hasLooks);
  readColours();
  listen();
  open(false);
  reset();
})();
