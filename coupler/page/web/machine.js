/* Walls and bodies, the lines between them (joints, springs, cables, drives), and the loads of the particles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
(function (tandem) {
  'use strict';

  const STILL = 0x9aa5b1, MOVING = [0x3d7ebf, 0xd08a2e, 0x4c9a6a, 0x9a5fa8, 0x2f9aa0, 0xb5606a, 0x7a7f2d, 0x6b6fc4];
  /* as in the pictures: protocol/draw/space/content.c */
  tandem.lineColours = {joint: 0xb22234, spring: 0x2e7d32, cable: 0x28282c, cylinder: 0x195aaa, bar: 0xc8783c};
  const LOAD = tandem.loadColour = 0xd41f3a;
  const NARROW = 0.01;      /* of the size of all: bars of a net, whose edges would make it black, have none */
  const EDGES_MOST = 30000; /* triangles of a body; the edges of more are not looked for */

  /* triangles of convex polygons */
  function triangles(polygons) {
    const corner = [];
    for (const p of polygons)
      for (let k = 1; k + 1 < p.corner.length / 3; k++)
        for (const c of [0, k, k + 1])
          corner.push(p.corner[3 * c], p.corner[3 * c + 1], p.corner[3 * c + 2]);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(corner), 3));
    geometry.computeVertexNormals();
    return geometry;
  }

  /* a polygon's area over its longest edge: of a strip its width */
  function width(p) {
    const at = (k) => new THREE.Vector3().fromArray(p.corner, 3 * (k % n)), n = p.corner.length / 3;
    const area = new THREE.Vector3();
    let longest = 0;
    for (let k = 0; k < n; k++) {
      longest = Math.max(longest, at(k).distanceTo(at(k + 1)));
      area.add(at(k).sub(at(0)).cross(at(k + 1).sub(at(0))));
    }
    return longest > 0 ? 0.5 * area.length() / longest : 0;
  }

  tandem.Machine = function (scene, run, size) {
    const meta = run.meta, planes = [], bodies = [];
    let moving = 0;

    const surface = (body, polygons, solid) => {
      if (!polygons.length)
        return;
      const geometry = triangles(polygons);
      const material = new THREE.MeshLambertMaterial({color: body.colour, side: THREE.DoubleSide, clippingPlanes: planes,
        transparent: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
      const mesh = new THREE.Mesh(geometry, material);
      mesh.userData = {body: body.index, solid};
      body.group.add(mesh);
      body.meshes.push(mesh);
      if (geometry.attributes.position.count / 3 > EDGES_MOST)
        return;
      const wide = polygons.filter((p) => width(p) > NARROW * size);
      const edges = new THREE.LineSegments(new THREE.EdgesGeometry(triangles(wide), 25),
        new THREE.LineBasicMaterial({color: new THREE.Color(body.colour).multiplyScalar(0.45), transparent: true,
                                     opacity: solid ? 0.8 : 0.45, clippingPlanes: planes}));
      body.group.add(edges);
    };

    meta.bodies.forEach((b, index) => {
      const colour = b.still ? STILL : MOVING[moving++ % MOVING.length];
      const body = {index, name: b.name, still: b.still, colour, group: new THREE.Group(), meshes: []};
      const own = run.polygons.filter((p) => p.body === index);
      surface(body, own.filter((p) => p.solid), true);
      surface(body, own.filter((p) => !p.solid), false);
      if (!own.length && !b.still) {
        const mark = new THREE.Mesh(new THREE.OctahedronGeometry(0.012 * size), new THREE.MeshLambertMaterial({color: colour}));
        mark.userData = {body: index};
        body.group.add(mark);
      }
      scene.add(body.group);
      bodies.push(body);
    });
    this.bodies = bodies;

    /* What is solid hides what is behind it as `opacity` says; containers and walls that stand let more through. */
    this.setOpacity = function (opacity) {
      for (const b of bodies)
        for (const mesh of b.meshes) {
          const m = mesh.material;
          m.opacity = opacity * (mesh.userData.solid ? (b.still ? 0.6 : 0.9) : 0.36);
          m.transparent = m.opacity < 0.999;
          m.depthWrite = m.opacity > 0.85;
        }
    };

    /* ---- lines: thin rods and dots, pooled ---- */

    const rodShape = new THREE.CylinderBufferGeometry(1, 1, 1, 8, 1, true).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    const dotShape = new THREE.SphereBufferGeometry(1, 12, 8);
    const lines = new THREE.Group(), loads = new THREE.Group(), materials = {};
    scene.add(lines, loads);
    for (const kind in tandem.lineColours)
      materials[kind] = new THREE.MeshBasicMaterial({color: tandem.lineColours[kind], transparent: true, opacity: 0.92,
                                                     depthTest: kind !== 'joint'});
    const pool = {rod: [], dot: []};
    let used;
    const piece = (what, shape, material) => {
      let mesh = pool[what][used[what]];
      if (!mesh) {
        mesh = pool[what][used[what]] = new THREE.Mesh(shape, material);
        lines.add(mesh);
      }
      used[what]++;
      mesh.material = material;
      mesh.renderOrder = material.depthTest ? 0 : 2;
      mesh.visible = true;
      return mesh;
    };
    const rod = (a, b, thick, material) => {
      const mesh = piece('rod', rodShape, material);
      mesh.position.copy(a);
      mesh.scale.set(thick, thick, Math.max(a.distanceTo(b), 1e-9));
      mesh.up.set(0.36, 0.48, 0.8); /* an odd one: not along the line */
      mesh.lookAt(b);
    };
    const dot = (a, thick, material) => {
      const mesh = piece('dot', dotShape, material);
      mesh.position.copy(a);
      mesh.scale.setScalar(thick);
    };

    function drawLines(frame) {
      used = {rod: 0, dot: 0};
      const at = (i) => new THREE.Vector3(frame.point[3 * i], frame.point[3 * i + 1], frame.point[3 * i + 2]);
      meta.lines.forEach((line, k) => {
        const from = k ? frame.lineEnd[k - 1] : 0, to = frame.lineEnd[k], material = materials[line.kind] || materials.other;
        if (to > from && (line.kind === 'joint' || to - from === 1))
          dot(at(from), 0.007 * size, material);
        for (let i = from; i + 1 < to; i++)
          rod(at(i), at(i + 1), (line.kind === 'cylinder' || line.kind === 'bar' ? 0.005 : line.kind === 'joint' ? 0.002 : 0.003) * size, material);
      });
      for (const what in pool)
        for (let i = used[what]; i < pool[what].length; i++)
          pool[what][i].visible = false;
    }

    /* ---- loads: an arrow at each body that particles press on ---- */

    const loadMaterial = new THREE.MeshBasicMaterial({color: LOAD, depthTest: false, transparent: true});
    const arrows = bodies.map(() => {
      const arrow = new THREE.Group(), shaft = new THREE.Mesh(rodShape, loadMaterial);
      const tip = new THREE.Mesh(new THREE.ConeBufferGeometry(1, 1, 12).rotateX(Math.PI / 2).translate(0, 0, -0.5), loadMaterial);
      shaft.renderOrder = tip.renderOrder = 3;
      arrow.add(shaft, tip);
      arrow.visible = false;
      arrow.userData = {shaft, tip};
      loads.add(arrow);
      return arrow;
    });
    function drawLoads(frame, mostLoad) {
      arrows.forEach((arrow, b) => {
        const f = new THREE.Vector3(frame.load[3 * b], frame.load[3 * b + 1], frame.load[3 * b + 2]), force = f.length();
        const length = 0.2 * size * force / mostLoad, thick = 0.004 * size, head = Math.min(0.5 * length, 5 * thick);
        arrow.visible = force > 0 && length > 0.008 * size;
        if (!arrow.visible)
          return;
        arrow.position.set(frame.pose[7 * b], frame.pose[7 * b + 1], frame.pose[7 * b + 2]);
        arrow.up.set(0.36, 0.48, 0.8);
        arrow.lookAt(f.add(arrow.position));
        arrow.userData.shaft.scale.set(thick, thick, length - 0.9 * head);
        arrow.userData.tip.scale.set(0.45 * head, 0.45 * head, head);
        arrow.userData.tip.position.z = length;
      });
    }

    this.show = function (frame, mostLoad) {
      this.frame = frame;
      bodies.forEach((b, k) => {
        const p = frame.pose.subarray(7 * k, 7 * k + 7);
        b.group.position.set(p[0], p[1], p[2]);
        b.group.quaternion.set(p[4], p[5], p[6], p[3]);
      });
      drawLines(frame);
      drawLoads(frame, mostLoad);
    };
    this.setLines = (on) => lines.visible = on;
    this.setLoads = (on) => loads.visible = on;
    this.setBody = (k, on) => bodies[k].group.visible = on;
    this.setCut = function (plane) {
      planes.length = 0;
      if (plane)
        planes.push(plane);
    };

    /* The first body that a ray meets: {body, distance}, or null. */
    this.pick = function (raycaster) {
      const meshes = [].concat(...bodies.filter((b) => b.group.visible).map((b) => b.group.children.filter((c) => c.isMesh)));
      for (const hit of raycaster.intersectObjects(meshes, false))
        if (planes.every((plane) => plane.distanceToPoint(hit.point) >= 0))
          return {body: hit.object.userData.body, distance: hit.distance, through: hit.object.material.opacity < 0.5};
      return null;
    };
  };
})(window.tandem);
