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
    varying vec3 centre, colour;
    varying float r;
    void main() {
      vec3 place = low + size * position;
      vec4 eye = modelViewMatrix * vec4(place, 1.0);
      centre = eye.xyz;
      colour = tint / 255.0;
      r = radius;
      float d = length(eye.xyz);
      gl_Position = projectionMatrix * eye;
      gl_PointSize = 0.0;
      if (dot(cut.xyz, place) > cut.w || d <= r || eye.z >= 0.0) {
        gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
        return;
      }
      float slope = length(eye.xy) / -eye.z, own = r / sqrt(d * d - r * r);
      gl_PointSize = 2.0 * pixels * (own + slope * slope * own) / max(1.0 - slope * own, 0.05) + 1.0;
    }`;

  const fragment = `
    uniform vec4 lens;   /* half width and height of the picture at one metre; its size in pixels */
    uniform mat4 projectionMatrix;
    varying vec3 centre, colour;
    varying float r;
    void main() {
      vec3 ray = normalize(vec3((2.0 * gl_FragCoord.xy / lens.zw - 1.0) * lens.xy, -1.0));
      float along = dot(ray, centre);
      vec3 off = along * ray - centre;
      float h2 = r * r - dot(off, off);
      if (h2 < 0.0)
        discard;
      float h = sqrt(h2);
      vec3 normal = (off - h * ray) / r;
      float light = 0.42 + 0.5 * max(dot(normal, vec3(0.30, 0.50, 0.81)), 0.0) + 0.14 * normal.y;
      gl_FragColor = vec4(colour * light * smoothstep(-0.25, 0.45, -dot(normal, ray)), 1.0);
    #ifdef GL_EXT_frag_depth
      float z = (along - h) * ray.z;
      gl_FragDepthEXT = 0.5 + 0.5 * (projectionMatrix[2][2] * z + projectionMatrix[3][2]) / -z;
    #endif
    }`;

  tandem.Grains = function (scene) {
    const uniforms = {low: {value: new THREE.Vector3()}, size: {value: new THREE.Vector3()}, pixels: {value: 1},
                      cut: {value: new THREE.Vector4(0, 0, 0, 1)}, lens: {value: new THREE.Vector4(1, 1, 1, 1)}};
    const material = new THREE.ShaderMaterial({uniforms, vertexShader: vertex, fragmentShader: fragment});
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
