/* Particles: each a point whose pixels find out where their ray meets the sphere, so that radius, outline, shading and
 * depth are those of a true sphere at any distance. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
(function (tandem) {
  'use strict';

  /* A sphere is seen from the eye under the angle a = asin(r/d) about its centre, which stands under the angle t from
   * the view's axis: its edge is at most tan(t + a) - tan t from its centre in the picture. */
  const vertex = `
    attribute float radius;
    attribute vec3 tint;
    uniform vec3 low, size;
    uniform float pixels;   /* of one metre at one metre's distance */
    uniform vec4 cut;       /* what lies before this plane is not drawn: normal, offset */
    varying vec4 grain;     /* centre as seen from the eye, radius */
    varying vec3 colour;
    varying vec2 spread;    /* width of the point [pixels]; half of it by the sphere's radius in the picture */
    void main() {
      vec3 place = low + size * position;
      vec4 eye = modelViewMatrix * vec4(place, 1.0);
      float d = length(eye.xyz), slope = length(eye.xy) / -eye.z;
      grain = vec4(eye.xyz, radius);
      colour = tint / 255.0;
      gl_Position = projectionMatrix * eye;
      gl_PointSize = 0.0;
      if (dot(cut.xyz, place) > cut.w || d <= radius || eye.z >= 0.0) {
        gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
        return;
      }
      float own = radius / sqrt(d * d - radius * radius);
      float width = 2.0 * pixels * (own + slope * slope * own) / max(1.0 - slope * own, 0.05);
      gl_PointSize = width > WIDE ? width + 1.0 : max(2.0 * pixels * own, 1.0);
      spread = vec2(width, gl_PointSize / (2.0 * pixels * own));
    }`;

  /* A wide sphere is exact; a small one is a disc with the shading and the depth of a sphere, which is cheaper. */
  const fragment = `
    uniform vec4 lens;   /* half width and height of the picture at one metre; its size in pixels */
    uniform mat4 projectionMatrix;
    varying vec4 grain;
    varying vec3 colour;
    varying vec2 spread;
    void main() {
      vec3 normal;
      float z, rim;
      if (spread.x > WIDE) {
        vec3 ray = normalize(vec3((2.0 * gl_FragCoord.xy / lens.zw - 1.0) * lens.xy, -1.0));
        float along = dot(ray, grain.xyz);
        vec3 off = along * ray - grain.xyz;
        float h2 = grain.w * grain.w - dot(off, off);
        if (h2 < 0.0)
          discard;
        float h = sqrt(h2);
        normal = (off - h * ray) / grain.w;
        z = (along - h) * ray.z;
        rim = -dot(normal, ray);
      } else {
        vec2 q = spread.y * (2.0 * gl_PointCoord - 1.0);
        float h2 = 1.0 - dot(q, q);
        if (h2 < 0.0)
          discard;
        normal = vec3(q.x, -q.y, sqrt(h2));
        z = grain.z + grain.w * normal.z;
        rim = normal.z;
      }
      float light = 0.42 + 0.5 * max(dot(normal, vec3(0.30, 0.50, 0.81)), 0.0) + 0.14 * normal.y;
      gl_FragColor = vec4(colour * (light * (0.55 + 0.45 * rim)), 1.0);
    #ifdef GL_EXT_frag_depth
      gl_FragDepthEXT = 0.5 + 0.5 * (projectionMatrix[2][2] * z + projectionMatrix[3][2]) / -z;
    #endif
    }`;

  tandem.Grains = function (scene) {
    const uniforms = {low: {value: new THREE.Vector3()}, size: {value: new THREE.Vector3()}, pixels: {value: 1},
                      cut: {value: new THREE.Vector4(0, 0, 0, 1)}, lens: {value: new THREE.Vector4(1, 1, 1, 1)}};
    const material = new THREE.ShaderMaterial({uniforms, vertexShader: vertex, fragmentShader: fragment,
                                               defines: {WIDE: '24.0'}});
    material.extensions.fragDepth = true;
    let points = null, capacity = 0;
    this.frame = this.roster = null;

    /* room for n particles */
    const make = (n) => {
      if (points) {
        scene.remove(points);
        points.geometry.dispose();
      }
      capacity = n;
      order = null;
      const geometry = new THREE.BufferGeometry();
      const add = (name, array, width, normalized) => {
        const attribute = new THREE.BufferAttribute(array, width, normalized);
        attribute.setUsage(THREE.DynamicDrawUsage);
        geometry.setAttribute(name, attribute);
      };
      add('position', new Uint16Array(3 * n), 3, true);
      add('tint', new Uint8Array(3 * n), 3, false);
      add('radius', new Float32Array(n), 1, false);
      points = new THREE.Points(geometry, material);
      points.frustumCulled = false;
      points.visible = this.visible;
      scene.add(points);
    };

    this.visible = true;
    this.setVisible = (on) => {
      this.visible = on;
      if (points)
        points.visible = on;
    };

    /* Show a frame in these colours. */
    this.show = function (frame, roster, paint) {
      if (frame.n > capacity)
        make(Math.ceil(1.25 * frame.n) + 16);
      this.frame = frame;
      const renewed = this.roster !== roster;
      this.roster = roster;
      if (!points)
        return;
      const a = points.geometry.attributes;
      a.position.array.set(frame.position);
      a.position.needsUpdate = true;
      if (renewed) {
        a.radius.array.set(roster.radius);
        a.radius.needsUpdate = true;
      }
      this.repaint(paint);
      points.geometry.setDrawRange(0, frame.n);
      uniforms.low.value.set(...frame.low);
      uniforms.size.value.set(...frame.size);
    };

    this.repaint = function (paint) {
      if (!points || !this.frame)
        return;
      const a = points.geometry.attributes.tint;
      paint(a.array);
      a.needsUpdate = true;
    };

    /* Leave out what others hide, for a processor that draws: it would shade every pixel of every particle. A particle
     * covers the cells of the picture that lie wholly within its outline, at its centre's depth; one all of whose cells
     * are covered by something before its foremost point cannot be seen. */
    let order = null, cells = null;
    this.cull = function (camera, width, height) {
      const f = this.frame, n = f ? f.n : 0, m = camera.matrixWorldInverse.elements, cut = uniforms.cut.value;
      if (!points || !n)
        return;
      const pixels = uniforms.pixels.value, lens = uniforms.lens.value, radius = this.roster.radius;
      const at = new Float32Array(4 * n); /* place in the picture, radius there, depth; depth 0: out of sight */
      let sum = 0, seen = 0;
      for (let i = 0; i < n; i++) {
        const x = f.low[0] + f.size[0] / 65535 * f.position[3 * i], y = f.low[1] + f.size[1] / 65535 * f.position[3 * i + 1];
        const z = f.low[2] + f.size[2] / 65535 * f.position[3 * i + 2], d = -(m[2] * x + m[6] * y + m[10] * z + m[14]);
        const scale = pixels / d, r = radius[i] * scale;
        const px = 0.5 * width + scale * (m[0] * x + m[4] * y + m[8] * z + m[12]);
        const py = 0.5 * height + scale * (m[1] * x + m[5] * y + m[9] * z + m[13]);
        if (d <= radius[i] || px < -r || py < -r || px > width + r || py > height + r || cut.x * x + cut.y * y + cut.z * z > cut.w)
          continue;
        at.set([px, py, r, d], 4 * i);
        sum += r;
        seen++;
      }
      const c = Math.max(1, sum / Math.max(1, seen) / 3), columns = Math.ceil(width / c) + 1, rows = Math.ceil(height / c) + 1;
      if (!cells || cells.length < columns * rows)
        cells = new Float32Array(columns * rows);
      cells.fill(Infinity);
      for (let i = 0; i < 4 * n; i += 4) {
        const px = at[i], py = at[i + 1], r = at[i + 2], d = at[i + 3];
        if (!d)
          continue;
        for (let j = Math.max(0, Math.ceil((py - r) / c)); j < rows && (j + 1) * c <= py + r; j++) {
          const off = Math.max(Math.abs(j * c - py), Math.abs((j + 1) * c - py)), half = Math.sqrt(Math.max(0, r * r - off * off));
          for (let k = Math.max(0, Math.ceil((px - half) / c)); k < columns && (k + 1) * c <= px + half; k++)
            if (d < cells[j * columns + k])
              cells[j * columns + k] = d;
        }
      }
      if (!order || order.length < n) {
        order = new Uint32Array(Math.ceil(1.25 * n) + 16);
        points.geometry.setIndex(new THREE.BufferAttribute(order, 1).setUsage(THREE.DynamicDrawUsage));
      }
      let count = 0;
      for (let i = 0; i < n; i++) {
        const px = at[4 * i], py = at[4 * i + 1], r = at[4 * i + 2], d = at[4 * i + 3];
        let hidden = true;
        const before = d - radius[i], last = Math.min(columns - 1, Math.floor((px + r) / c));
        for (let j = Math.max(0, Math.floor((py - r) / c)); d && hidden && j < rows && j * c < py + r; j++)
          for (let k = Math.max(0, Math.floor((px - r) / c)); hidden && k <= last; k++)
            hidden = cells[j * columns + k] < before;
        if (!hidden)
          order[count++] = i;
      }
      points.geometry.index.needsUpdate = true;
      points.geometry.setDrawRange(0, count);
      this.drawn = count;
    };

    this.setCut = (normal, offset) => uniforms.cut.value.set(normal[0], normal[1], normal[2], offset);

    this.setLens = function (camera, width, height) {
      const tan = Math.tan(camera.fov * Math.PI / 360);
      uniforms.lens.value.set(tan * camera.aspect, tan, width, height);
      uniforms.pixels.value = 0.5 * height / tan;
    };

    /* where particle i is */
    this.place = function (i) {
      const f = this.frame;
      return [0, 1, 2].map((c) => f.low[c] + f.size[c] / 65535 * f.position[3 * i + c]);
    };

    /* The first particle that a ray meets: {index, distance}, or null. */
    this.pick = function (ray) {
      const f = this.frame, o = ray.origin, d = ray.direction, cut = uniforms.cut.value;
      let best = null;
      for (let i = 0; this.visible && f && i < f.n; i++) {
        const x = f.low[0] + f.size[0] / 65535 * f.position[3 * i], y = f.low[1] + f.size[1] / 65535 * f.position[3 * i + 1];
        const z = f.low[2] + f.size[2] / 65535 * f.position[3 * i + 2], r = this.roster.radius[i];
        const along = (x - o.x) * d.x + (y - o.y) * d.y + (z - o.z) * d.z;
        const ex = o.x + along * d.x - x, ey = o.y + along * d.y - y, ez = o.z + along * d.z - z;
        const h2 = r * r - ex * ex - ey * ey - ez * ez;
        if (h2 < 0 || along < r || cut.x * x + cut.y * y + cut.z * z > cut.w)
          continue;
        const distance = along - Math.sqrt(h2);
        if (!best || distance < best.distance)
          best = {index: i, distance};
      }
      return best;
    };
  };
})(window.tandem);
