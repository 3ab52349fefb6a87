/* The view in space: camera, light, grid, the plane that cuts, and what is written over it (axes, scale, names). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
(function (tandem) {
  'use strict';

  /* Whether a processor draws, and smooth edges cost too much. */
  function isSoftware() {
    const gl = document.createElement('canvas').getContext('webgl'), info = gl && gl.getExtension('WEBGL_debug_renderer_info');
    return !gl || !info || /swiftshader|llvmpipe|software|softpipe/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
  }

  /* Widen the box by the particles of a few frames, but for the fiftieth that lies farthest out along each axis: what
   * flies away does not make the machine small. */
  function addParticles(box, run) {
    const n = run.times.length, place = [[], [], []];
    for (let j = 0; j < Math.min(n, 5); j++) {
      const f = run.frame(Math.round(j * (n - 1) / Math.max(1, Math.min(n, 5) - 1))), step = Math.max(1, Math.floor(f.n / 1000));
      for (let i = 0; i < f.n; i += step)
        for (let c = 0; c < 3; c++)
          place[c].push(f.low[c] + f.size[c] / 65535 * f.position[3 * i + c]);
    }
    if (!place[0].length)
      return;
    for (const values of place)
      values.sort((x, y) => x - y);
    for (const share of [0.02, 0.98])
      box.expandByPoint(new THREE.Vector3(...place.map((values) => values[Math.round(share * (values.length - 1))])));
  }

  /* The box of a run: particles; bodies at the first frame and the last, the lines' points; walls that stand unless they
   * are much wider, as cuts through planes without end may be. */
  function boxOf(run) {
    const box = new THREE.Box3(), wide = new THREE.Box3(), point = new THREE.Vector3(), n = run.times.length;
    const add = (x, y, z) => Number.isFinite(x + y + z) && box.expandByPoint(point.set(x, y, z));
    addParticles(box, run);
    for (const k of n > 1 ? [0, n - 1] : n ? [0] : []) {
      const f = run.frame(k), q = new THREE.Quaternion();
      for (let i = 0; i < f.npoint; i++)
        add(f.point[3 * i], f.point[3 * i + 1], f.point[3 * i + 2]);
      for (const p of run.polygons) {
        const o = 7 * p.body, into = run.meta.bodies[p.body].still && !p.solid ? wide : box;
        q.set(f.pose[o + 4], f.pose[o + 5], f.pose[o + 6], f.pose[o + 3]);
        for (let c = 0; c < p.corner.length; c += 3) {
          point.set(p.corner[c], p.corner[c + 1], p.corner[c + 2]).applyQuaternion(q);
          into.expandByPoint(point.add(new THREE.Vector3(f.pose[o], f.pose[o + 1], f.pose[o + 2])));
        }
      }
    }
    if (!wide.isEmpty() && (box.isEmpty() || wide.getSize(point).length() < 2 * box.getSize(new THREE.Vector3()).length()))
      box.union(wide);
    if (box.isEmpty())
      box.set(new THREE.Vector3(-0.5, -0.5, -0.5), new THREE.Vector3(0.5, 0.5, 0.5));
    return box;
  }

  /* 1, 2 or 5 times a power of ten, at most x */
  const round125 = (x) => {
    const p = 10 ** Math.floor(Math.log10(x));
    return p * (x / p >= 5 ? 5 : x / p >= 2 ? 2 : 1);
  };
  tandem.round125 = round125;

  tandem.length = (x) => x < 1e-3 ? tandem.number(1e6 * x) + ' µm' : x < 0.1 ? tandem.number(1e3 * x) + ' mm' : tandem.number(x) + ' m';

  tandem.Space = function (canvas, overlay, run) {
    const box = boxOf(run), centre = box.getCenter(new THREE.Vector3()), extent = box.getSize(new THREE.Vector3());
    const size = Math.max(extent.length(), 1e-6);
    const g = run.meta.gravity || [0, 0, 0], weight = Math.hypot(...g);
    const up = new THREE.Vector3(...(weight > 0 ? g.map((x) => -x / weight) : [0, 0, 1]));
    const software = isSoftware(), renderer = new THREE.WebGLRenderer({canvas, antialias: !software, preserveDrawingBuffer: true});
    renderer.localClippingEnabled = true;
    renderer.setClearColor(0xeaeff5, 1);
    const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(32, 1, 0.002 * size, 40 * size);
    camera.up.copy(up);
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.screenSpacePanning = true;
    controls.enableKeys = false;
    const lamp = new THREE.DirectionalLight(0xffffff, 0.62);
    scene.add(new THREE.HemisphereLight(0xffffff, 0xb8c0cc, 0.62), camera);
    scene.children[0].position.copy(up);
    camera.add(lamp);
    lamp.position.set(0.3, 0.5, 0.8);
    Object.assign(this, {scene, camera, controls, renderer, box, size, up, canvas});

    const grains = this.grains = new tandem.Grains(scene);
    const machine = this.machine = new tandem.Machine(scene, run, size);

    /* ---- the grid under everything, across the upward axis that is nearest to `up` ---- */

    const axis = ['x', 'y', 'z'].reduce((a, b) => Math.abs(up[b]) > Math.abs(up[a]) ? b : a), across = ['x', 'y', 'z'].filter((a) => a !== axis);
    const cell = this.cell = round125(0.12 * size);
    const grid = new THREE.Group();
    {
      const low = up[axis] > 0 ? box.min[axis] : box.max[axis], corner = [];
      const range = across.map((a) => [Math.floor((box.min[a] - cell) / cell), Math.ceil((box.max[a] + cell) / cell)]);
      for (let side = 0; side < 2; side++)
        for (let k = range[side][0]; k <= range[side][1]; k++)
          for (const end of range[1 - side]) {
            const p = new THREE.Vector3();
            p[axis] = low - 0.002 * size * Math.sign(up[axis]);
            p[across[side]] = k * cell;
            p[across[1 - side]] = end * cell;
            corner.push(p);
          }
      grid.add(new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(corner),
        new THREE.LineBasicMaterial({color: 0x8f9bab, transparent: true, opacity: 0.45, depthWrite: false})));
      scene.add(grid);
    }
    this.setGrid = (on) => grid.visible = on;

    /* ---- cameras ---- */

    const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), up);
    const directions = {space: [0.62, -1, 0.5], x: [1, 0, 0], y: [0, -1, 0], top: [0, -0.001, 1]};
    this.look = function (name) {
      if (run.meta.live) { /* it may have grown */
        box.copy(boxOf(run));
        box.getCenter(centre);
        box.getSize(extent);
      }
      const direction = new THREE.Vector3(...directions[name]).normalize().applyQuaternion(turn);
      controls.target.copy(centre);
      /* as near as the box's corners allow */
      camera.position.copy(centre).addScaledVector(direction, size);
      camera.lookAt(centre);
      camera.updateMatrixWorld();
      const tan = Math.tan(camera.fov * Math.PI / 360), back = camera.matrixWorldInverse.getInverse(camera.matrixWorld);
      let distance = 0;
      for (let k = 0; k < 8; k++) {
        const p = new THREE.Vector3(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y, k & 4 ? box.max.z : box.min.z).applyMatrix4(back);
        distance = Math.max(distance, size + p.z + 1.12 * Math.max(Math.abs(p.y), Math.abs(p.x) / camera.aspect) / tan);
      }
      camera.position.copy(centre).addScaledVector(direction, distance);
      controls.update();
      this.draw();
    };

    /* Pixels of the picture by those of the page. Where a processor draws and is too slow, fewer while something moves,
     * and all of them again at rest. */
    const fullRatio = () => Math.min(window.devicePixelRatio || 1, 2);
    let ratio = 0, moving = 1, last = -Infinity, pace = 0, rest = 0;
    function setRatio(wanted) {
      if (wanted === ratio)
        return;
      ratio = wanted;
      renderer.setPixelRatio(ratio);
      renderer.setSize(canvas.clientWidth || 1, canvas.clientHeight || 1, false);
      grains.setLens(camera, canvas.width, canvas.height);
    }
    const adapt = () => {
      const now = performance.now(), gap = now - last;
      last = now;
      clearTimeout(rest);
      if (gap > 300) {
        setRatio(fullRatio());
        return;
      }
      pace = 0.7 * pace + 0.3 * gap;
      if (pace > 45 && moving > 0.5) {
        moving -= 0.25;
        pace = 30;
      }
      setRatio(moving * fullRatio());
      rest = setTimeout(() => {
        last = -Infinity;
        this.drawNow(true);
      }, 350);
    };

    this.resize = function () {
      const width = canvas.clientWidth || 1, height = canvas.clientHeight || 1;
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      overlay.width = width * fullRatio();
      overlay.height = height * fullRatio();
      ratio = 0;
      setRatio(fullRatio());
      this.draw();
    };

    /* ---- the plane that cuts ---- */

    const outline = new THREE.LineLoop(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({color: 0xd41f3a}));
    outline.visible = false;
    scene.add(outline);
    /* axis "x", "y", "z" or ""; share 0 ... 1 of the box's width; what lies beyond (or, turned, before) goes */
    this.setCut = function (along, share, turned) {
      outline.visible = along !== '';
      if (!along) {
        machine.setCut(null);
        grains.setCut([0, 0, 0], 1);
      } else {
        const sign = turned ? -1 : 1, normal = new THREE.Vector3(), offset = box.min[along] + share * extent[along];
        normal[along] = sign;
        machine.setCut(new THREE.Plane(normal.clone().negate(), sign * offset));
        grains.setCut(normal.toArray(), sign * offset);
        const [a, b] = ['x', 'y', 'z'].filter((c) => c !== along);
        outline.geometry.setFromPoints([[0, 0], [1, 0], [1, 1], [0, 1]].map((s) => {
          const p = new THREE.Vector3();
          p[along] = offset;
          p[a] = s[0] ? box.max[a] : box.min[a];
          p[b] = s[1] ? box.max[b] : box.min[b];
          return p;
        }));
        this.cutAt = offset;
      }
      this.draw();
    };

    /* ---- what was clicked ---- */

    const ring = new THREE.Mesh(new THREE.TorusBufferGeometry(1, 0.09, 8, 40), new THREE.MeshBasicMaterial({color: 0xe0007f, depthTest: false, transparent: true}));
    ring.visible = false;
    ring.renderOrder = 4;
    scene.add(ring);
    this.mark = function (place, radius) {
      ring.visible = !!place;
      if (place) {
        ring.position.set(...place);
        ring.scale.setScalar(Math.max(1.15 * radius, 0.008 * size));
      }
    };
    const raycaster = new THREE.Raycaster();
    /* {particle: index} or {body: number} at this pixel of the page, or null */
    this.pick = function (x, y) {
      const rect = canvas.getBoundingClientRect();
      raycaster.setFromCamera({x: 2 * (x - rect.left) / rect.width - 1, y: 1 - 2 * (y - rect.top) / rect.height}, camera);
      const grain = grains.pick(raycaster.ray), body = machine.pick(raycaster);
      if (grain && (!body || body.through || grain.distance < body.distance))
        return {particle: grain.index};
      return body ? {body: body.body} : null;
    };
    /* where a place is on the page */
    this.project = function (place) {
      const p = new THREE.Vector3(...place).project(camera), rect = canvas.getBoundingClientRect();
      return [rect.left + 0.5 * (p.x + 1) * rect.width, rect.top + 0.5 * (1 - p.y) * rect.height, p.z];
    };

    /* ---- over the picture ---- */

    this.names = true;
    function write(c, text, x, y, colour) {
      c.lineWidth = 3;
      c.strokeStyle = 'rgba(255,255,255,0.85)';
      c.strokeText(text, x, y);
      c.fillStyle = colour;
      c.fillText(text, x, y);
    }
    function drawAxes(c, height) {
      const back = camera.quaternion.clone().conjugate(), x0 = 48, y0 = height - 52;
      const axes = [['x', '#c0392b', [1, 0, 0]], ['y', '#2e8b3d', [0, 1, 0]], ['z', '#2457b0', [0, 0, 1]]]
        .map(([name, colour, v]) => ({name, colour, v: new THREE.Vector3(...v).applyQuaternion(back)}))
        .sort((a, b) => a.v.z - b.v.z);
      c.textAlign = 'center';
      for (const a of axes) {
        c.beginPath();
        c.moveTo(x0, y0);
        c.lineTo(x0 + 28 * a.v.x, y0 - 28 * a.v.y);
        c.lineWidth = 2.5;
        c.strokeStyle = a.colour;
        c.stroke();
        write(c, a.name, x0 + 38 * a.v.x, y0 - 38 * a.v.y, a.colour);
      }
    }
    function drawScale(c, width, height) {
      const perMetre = 0.5 * height / Math.tan(camera.fov * Math.PI / 360) / camera.position.distanceTo(controls.target);
      const length = round125(130 / perMetre), x = 104, y = height - 30;
      c.beginPath();
      c.moveTo(x, y - 5);
      c.lineTo(x, y);
      c.lineTo(x + length * perMetre, y);
      c.lineTo(x + length * perMetre, y - 5);
      c.lineWidth = 1.5;
      c.strokeStyle = '#2b3440';
      c.stroke();
      c.textAlign = 'left';
      write(c, tandem.length(length) + (grid.visible ? '   (grid ' + tandem.length(cell) + ')' : ''), x, y - 10, '#2b3440');
    }
    function drawNames(c, rect) {
      c.textAlign = 'left';
      for (const b of machine.bodies) {
        if (b.still || !b.group.visible)
          continue;
        const p = b.group.position.toArray(), s = new THREE.Vector3(...p).project(camera);
        if (s.z < 1)
          write(c, b.name, 0.5 * (s.x + 1) * rect[0] + 8, 0.5 * (1 - s.y) * rect[1] - 8, '#' + new THREE.Color(b.colour).multiplyScalar(0.6).getHexString());
      }
    }

    /* drawn by the processor: text on a canvas costs a software renderer more than all particles */
    const over = overlay.getContext('2d', {willReadFrequently: true});
    let asked = false;
    /* Draw soon, once for all that changed. */
    this.draw = function () {
      if (!asked) {
        asked = true;
        requestAnimationFrame(() => this.drawNow());
      }
    };
    /* `still`: with all pixels, however long it takes */
    this.drawNow = function (still) {
      asked = false;
      if (software && !still)
        adapt();
      else
        setRatio(fullRatio());
      if (ring.visible)
        ring.quaternion.copy(camera.quaternion);
      if (software)
        grains.cull(camera, canvas.width, canvas.height);
      renderer.render(scene, camera);
      const c = over, full = fullRatio(), width = overlay.width / full, height = overlay.height / full;
      c.setTransform(full, 0, 0, full, 0, 0);
      c.clearRect(0, 0, width, height);
      c.font = '600 12px system-ui, sans-serif';
      drawAxes(c, height);
      drawScale(c, width, height);
      if (this.names)
        drawNames(c, [width, height]);
    };
    controls.addEventListener('change', () => this.draw());
    /* near and far follow the distance, so that depth stays exact */
    controls.addEventListener('change', () => {
      const d = camera.position.distanceTo(centre);
      camera.near = Math.max(0.001 * size, 0.02 * d, d - 4 * size);
      camera.far = d + 8 * size;
      camera.updateProjectionMatrix();
    });
  };
})(window.tandem);
