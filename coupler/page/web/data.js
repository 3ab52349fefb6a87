/* What the page is shown, unpacked; coupler/page/pack.h and channels.h say what the bytes are. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
window.tandem = {};

(function (tandem) {
  'use strict';

  /* half precision: all 65536 numbers */
  const half = new Float32Array(65536);
  for (let i = 0; i < 65536; i++) {
    const sign = i & 0x8000 ? -1 : 1, exponent = (i >> 10) & 31, fraction = i & 1023;
    half[i] = exponent === 0 ? sign * fraction * 2 ** -24
            : exponent < 31 ? sign * (1 + fraction / 1024) * 2 ** (exponent - 15)
            : fraction ? NaN : sign * Infinity;
  }
  tandem.half = half;

  function check(view) {
    if (view.getUint32(0, true) !== 1)
      throw new Error('the data of this page are of another version');
  }

  const floats = (view, at, n) => Array.from({length: n}, (_, i) => view.getFloat32(at + 4 * i, true));

  /* the fixed part of a frame: also of one that is cut off behind it */
  function head(buffer) {
    const view = new DataView(buffer);
    check(view);
    return {
      roster: view.getUint32(4, true), time: view.getFloat64(8, true),
      n: view.getUint32(16, true), nbody: view.getUint32(20, true),
      nline: view.getUint32(24, true), npoint: view.getUint32(28, true),
      low: floats(view, 32, 3), size: floats(view, 44, 3), scale: floats(view, 56, 3),
      most: {speed: view.getFloat32(68, true), spin: view.getFloat32(72, true),
             force: view.getFloat32(76, true), load: view.getFloat32(80, true)},
    };
  }
  const HEAD_BYTES = 84;

  tandem.unpackFrame = function (buffer) {
    const f = head(buffer);
    let at = HEAD_BYTES;
    const take = (Type, count) => {
      const array = new Type(buffer, at, count);
      at += array.byteLength;
      return array;
    };
    f.pose = take(Float32Array, 7 * f.nbody);
    f.load = take(Float32Array, 3 * f.nbody);
    f.lineEnd = take(Uint32Array, f.nline);
    f.point = take(Float32Array, 3 * f.npoint);
    f.position = take(Uint16Array, 3 * f.n);
    f.velocity = take(Uint16Array, 3 * f.n);
    f.spin = take(Uint16Array, 3 * f.n);
    f.force = take(Uint16Array, 3 * f.n);
    return f;
  };

  tandem.unpackRoster = function (buffer) {
    const view = new DataView(buffer);
    check(view);
    const n = view.getUint32(8, true);
    return {
      serial: view.getUint32(4, true), n, low: floats(view, 16, 3), size: floats(view, 28, 3),
      id: new Uint32Array(buffer, 40, n), radius: new Float32Array(buffer, 40 + 4 * n, n),
      born: new Uint16Array(buffer, 40 + 8 * n, 3 * n), material: new Uint8Array(buffer, 40 + 14 * n, n),
      sizeClass: new Int8Array(buffer, 40 + 15 * n, n),
    };
  };

  /* polygons: {body, solid, corner: [x, y, z, x, ...]} */
  tandem.unpackSurface = function (buffer) {
    const view = new DataView(buffer);
    check(view);
    const q = view.getUint32(4, true), body = new Uint32Array(buffer, 16, q), kind = new Uint32Array(buffer, 16 + 4 * q, q);
    const polygons = [];
    let at = 16 + 8 * q;
    for (let i = 0; i < q; i++) {
      const corners = kind[i] & 255;
      polygons.push({body: body[i], solid: kind[i] >= 256, corner: new Float32Array(buffer, at, 3 * corners)});
      at += 12 * corners;
    }
    return polygons;
  };

  /* {time, column: [values, ...]} */
  tandem.unpackChannels = function (buffer) {
    const view = new DataView(buffer);
    check(view);
    const c = view.getUint32(4, true), r = view.getUint32(8, true), column = [];
    for (let i = 0; i < c; i++)
      column.push(new Float32Array(buffer, 16 + 4 * r * (i + 1), r));
    return {time: new Float32Array(buffer, 16, r), column};
  };

  function bytesOf(base64) {
    const text = atob(base64), bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++)
      bytes[i] = text.charCodeAt(i);
    return bytes.buffer;
  }

  /* ---- the run on the page ---- */

  const textOf = (id) => {
    const element = document.getElementById(id);
    return element ? element.textContent : null;
  };

  /* A run: meta, polygons, channels(k); times of its frames; frame(k), head(k) and roster(serial) of them. That of a
   * page with meta.live is under way (live.js). */
  tandem.pageRun = function () {
    const meta = JSON.parse(textOf('meta'));
    if (meta.live)
      return tandem.liveRun(meta, tandem.unpackSurface(bytesOf(textOf('surface'))));
    const kept = new Map(), rosters = new Map(), heads = [];
    const remember = (map, key, most, make) => {
      if (map.has(key)) {
        const value = map.get(key);
        map.delete(key);
        map.set(key, value);
        return value;
      }
      const value = make();
      map.set(key, value);
      if (map.size > most)
        map.delete(map.keys().next().value); /* what was longest not asked for */
      return value;
    };
    return {
      meta, times: meta.times,
      polygons: tandem.unpackSurface(bytesOf(textOf('surface'))),
      channels: (k) => tandem.unpackChannels(bytesOf(textOf('channels' + k))),
      frame: (k) => remember(kept, k, 64, () => tandem.unpackFrame(bytesOf(textOf('frame' + k)))),
      roster: (serial) => remember(rosters, serial, 64, () => tandem.unpackRoster(bytesOf(textOf('roster' + serial)))),
      head: (k) => heads[k] = heads[k] || head(bytesOf(textOf('frame' + k).slice(0, 4 * HEAD_BYTES / 3))),
    };
  };
})(window.tandem);
