/* What particles can be coloured by, and the colours. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
(function (tandem) {
  'use strict';

  const anchors = [[38, 41, 110], [33, 96, 160], [32, 150, 157], [94, 190, 106], [210, 210, 62], [247, 148, 40], [214, 40, 40]];

  /* 256 colours from low to high, three bytes each */
  tandem.ramp = new Uint8Array(3 * 256);
  for (let i = 0; i < 256; i++) {
    const x = i / 255 * (anchors.length - 1), k = Math.min(Math.floor(x), anchors.length - 2);
    for (let c = 0; c < 3; c++)
      tandem.ramp[3 * i + c] = Math.round(anchors[k][c] + (x - k) * (anchors[k + 1][c] - anchors[k][c]));
  }

  /* colours of kinds, told apart also by who sees few colours */
  tandem.kinds = [[0, 114, 178], [230, 159, 0], [0, 158, 115], [204, 121, 167], [213, 94, 0], [86, 180, 233],
                  [240, 228, 66], [110, 80, 160], [120, 120, 120], [150, 90, 50]];
  tandem.css = (rgb) => `rgb(${rgb[0]},${rgb[1]},${rgb[2]})`;

  const half = (array, scale) => (i) =>
    scale * Math.hypot(tandem.half[array[3 * i]], tandem.half[array[3 * i + 1]], tandem.half[array[3 * i + 2]]);
  const place = (f, r, up) => {
    const k = up.map((u, c) => u * f.size[c] / 65535), off = up[0] * f.low[0] + up[1] * f.low[1] + up[2] * f.low[2];
    return (i) => off + k[0] * f.position[3 * i] + k[1] * f.position[3 * i + 1] + k[2] * f.position[3 * i + 2];
  };
  const born = (c) => (f, r) => (i) => r.low[c] + r.size[c] / 65535 * r.born[3 * i + c];

  /* name, unit, values(frame, roster, up) -> number of particle i; kinds: whole numbers with names; zero: the scale
   * begins there */
  tandem.quantities = {
    speed: {name: 'speed', unit: 'm/s', zero: true, values: (f) => half(f.velocity, f.scale[0])},
    force: {name: 'contact force', unit: 'N', zero: true, values: (f) => half(f.force, f.scale[2])},
    spin: {name: 'angular speed', unit: 'rad/s', zero: true, values: (f) => half(f.spin, f.scale[1])},
    height: {name: 'height', unit: 'm', values: place},
    radius: {name: 'radius', unit: 'm', values: (f, r) => (i) => r.radius[i]},
    id: {name: 'id', unit: '', values: (f, r) => (i) => r.id[i]},
    bornX: {name: 'x of birth', unit: 'm', values: born(0)},
    bornY: {name: 'y of birth', unit: 'm', values: born(1)},
    bornZ: {name: 'z of birth', unit: 'm', values: born(2)},
    material: {name: 'material', unit: '', kinds: (meta) => meta.materials, values: (f, r) => (i) => r.material[i]},
    sizeClass: {name: 'size class', unit: '', kinds: (meta) => classes(meta.edges), values: (f, r) => (i) => r.sizeClass[i]},
  };

  function classes(edges) {
    if (!edges.length)
      return [];
    const mm = (x) => tandem.number(2000 * x) + ' mm';
    return ['under ' + mm(edges[0]), ...edges.slice(1).map((e, i) => mm(edges[i]) + ' to ' + mm(e)),
            'over ' + mm(edges[edges.length - 1])];
  }

  /* The range of a quantity that shows most of it: over a few frames, without the last hundredth. */
  tandem.rangeOf = function (run, quantity, up) {
    const sample = [], n = run.times.length;
    for (let j = 0; j < Math.min(n, 6); j++) {
      const f = run.frame(Math.round(j * (n - 1) / Math.max(1, Math.min(n, 6) - 1))), r = run.roster(f.roster);
      const value = quantity.values(f, r, up), step = Math.max(1, Math.floor(f.n / 2000));
      for (let i = 0; i < f.n; i += step)
        if (Number.isFinite(value(i)))
          sample.push(value(i));
    }
    sample.sort((a, b) => a - b);
    if (!sample.length)
      return [0, 1];
    const at = (share) => sample[Math.round(share * (sample.length - 1))];
    const low = quantity.zero ? 0 : at(0), high = quantity.zero ? at(0.99) || at(1) : at(1);
    return high > low ? [low, high] : [low - (quantity.zero ? 0 : 0.5 * Math.abs(low) || 0.5), low + (0.5 * Math.abs(low) || 0.5)];
  };

  /* Colours of all particles, three bytes each, into `out`. */
  tandem.paint = function (out, frame, roster, quantity, range, up) {
    const value = quantity.values(frame, roster, up), ramp = tandem.ramp, kinds = tandem.kinds;
    const k = 255 / (range[1] - range[0]);
    for (let i = 0; i < frame.n; i++) {
      const x = value(i);
      if (quantity.kinds) {
        const c = x < 0 ? [190, 190, 190] : kinds[x % kinds.length];
        out[3 * i] = c[0], out[3 * i + 1] = c[1], out[3 * i + 2] = c[2];
      } else {
        const at = 3 * (x > range[0] ? x < range[1] ? (k * (x - range[0])) | 0 : 255 : 0);
        out[3 * i] = ramp[at], out[3 * i + 1] = ramp[at + 1], out[3 * i + 2] = ramp[at + 2];
      }
    }
  };

  /* a number with four digits, as short as it can be */
  tandem.number = (x) => {
    if (x === null || !Number.isFinite(x))
      return 'not known';
    const size = Math.abs(x);
    return size && (size < 1e-3 || size >= 1e5) ? x.toExponential(2).replace('e+', 'e') : String(Number(x.toPrecision(4)));
  };
})(window.tandem);
