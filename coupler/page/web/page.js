/* The page: it shows a run (data.js; live.js while it goes on), and does what the user asks for. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
(function (tandem) {
  'use strict';

  const $ = (id) => document.getElementById(id);
  const run = tandem.pageRun();
  const meta = run.meta;
  let space = null, curves = null, now = 0, playing = false, clock = 0, picked = null;
  let colour = 'speed', range = [0, 1], ranges = {}, mostLoad = 1;
  const typed = new Set(); /* quantities whose range the user has given */

  /* ---- what stands at the top ---- */

  function tellStatus() {
    const scene = (meta.scene || 'a run of tandem').split('/').slice(-2).join('/');
    $('title').textContent = scene;
    $('title').title = meta.scene || '';
    document.title = 'tandem: ' + scene;
    const words = {running: ['running', ''], lost: ['lost', 'bad'], TDM_OK: ['finished', 'good'], unfinished: ['unfinished', 'bad'], TDM_ERR_INTERRUPTED: ['interrupted', '']};
    const [word, kind] = words[meta.status] || (meta.status ? ['failed', 'bad'] : ['', '']);
    $('status').textContent = word;
    $('status').className = kind;
    $('status').hidden = !word;
    const notes = $('notes');
    notes.textContent = '';
    const add = (text, bad) => {
      const div = document.createElement('div');
      div.textContent = text;
      div.className = bad ? 'bad' : '';
      notes.append(div);
    };
    if (meta.status === 'TDM_ERR_INTERRUPTED')
      add('The run was interrupted: this shows what it did until then.', false);
    else if (meta.error)
      add('The run failed, and this shows what it did until then: ' + meta.error, true);
    else if (meta.status === 'unfinished')
      add('The run was ended by force, or goes on: what it wrote is shown.', true);
    for (const text of meta.notes || [])
      add(text, false);
    for (const w of meta.warnings || [])
      add('Warning: ' + (w.path ? w.path + ': ' : '') + w.message +
          (w.count > 1 ? ` (${w.count} times, first at t = ${tandem.number(w.first_s)} s)` : ''), false);
  }

  /* What the run says of its own error, beside what it took. */
  function tellTrust() {
    const e = meta.error_estimate, wall = meta.wall_s && meta.wall_s.all;
    $('trust').hidden = !e;
    if (!e)
      return;
    const units = {position: 'm', velocity: 'm/s', angle: 'rad', angular_velocity: 'rad/s'}, lines = [];
    for (const [name, body] of Object.entries(e.bodies || {}))
      for (const [quantity, unit] of Object.entries(units))
        if (body[quantity] && body[quantity].spread > 0 && typeof body[quantity].rms === 'number')
          lines.push(`${name}: ${quantity.replace('_', ' ')} ${tandem.number(body[quantity].rms)} ${unit}`);
    const known = typeof e.worst === 'number';
    $('trust').textContent = 'error, estimated: ' + (known ? (100 * e.worst).toPrecision(2) + ' %' : 'unknown') +
        (e.large ? ' (large)' : '') +
        (wall ? `, ${wall.toPrecision(3)} s wall` : '');
    $('trust').title = known ? 'rms, beside how far each quantity goes\n' + lines.join('\n') : e.unknown || '';
  }

  /* ---- frames ---- */

  const up = () => space.up.toArray();

  function showFrame(k) {
    now = Math.min(Math.max(Math.round(k), 0), Math.max(0, run.times.length - 1));
    if (space && run.times.length) {
      const f = run.frame(now), r = run.roster(f.roster);
      takeLoads(f);
      space.grains.show(f, r, paint);
      space.machine.show(f, mostLoad);
      showPicked();
      space.draw();
    }
    tellTime();
  }

  /* Loads that the frames do not have are those of the coupled bodies' histories: the mean since the row before. */
  function takeLoads(f) {
    meta.bodies.forEach((b, k) => {
      if (!Number.isFinite(f.load[3 * k]) && curves)
        f.load.set(curves.at(`body_${b.name}.csv`, ['fx', 'fy', 'fz'], f.time), 3 * k);
    });
  }

  function tellTime() {
    const n = run.times.length;
    $('slider').max = Math.max(0, n - 1);
    $('slider').value = now;
    $('time').textContent = n ? `${run.times[now].toFixed(decimals())} s   ${now + 1}/${n}` : '';
    if (curves && n)
      curves.setTime(run.times[now]);
  }
  const decimals = () => {
    const n = run.times.length, step = n > 1 ? (run.times[n - 1] - run.times[0]) / (n - 1) : 1;
    return Math.min(6, Math.max(1, 1 - Math.floor(Math.log10(step || 1))));
  };

  /* the frame nearest to a time */
  function frameAt(time) {
    let best = 0;
    for (let k = 1; k < run.times.length; k++)
      if (Math.abs(run.times[k] - time) < Math.abs(run.times[best] - time))
        best = k;
    return best;
  }

  function setPlaying(on) {
    playing = on && run.times.length > 1;
    $('play').textContent = playing ? '❚❚' : '▶';
    if (playing) {
      if (now === run.times.length - 1)
        showFrame(0);
      clock = run.times[now];
      let last = performance.now();
      const tick = (wall) => {
        if (!playing)
          return;
        clock += Number($('speed').value) * Math.min(0.25, Math.max(0, wall - last) / 1000);
        last = wall;
        let k = now;
        while (k + 1 < run.times.length && run.times[k + 1] <= clock)
          k++;
        if (k !== now)
          showFrame(k);
        if (now === run.times.length - 1)
          setPlaying(false);
        else
          requestAnimationFrame(tick);
      };
      requestAnimationFrame(tick);
    }
  }

  /* speeds around the one that plays the run in about ten seconds */
  function offerSpeeds() {
    const n = run.times.length, span = n > 1 ? run.times[n - 1] - run.times[0] : 1, own = tandem.round125(Math.max(span, 1e-9) / 8);
    const speeds = [...new Set([0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, own])].sort((a, b) => a - b);
    for (const s of speeds)
      $('speed').add(new Option(tandem.number(s) + ' ×', s, false, s === (span >= 3 && span <= 20 ? 1 : own)));
    $('speed').title = 'simulated seconds a second';
  }

  /* ---- colours ---- */

  const paint = (out) => tandem.paint(out, space.grains.frame, space.grains.roster, tandem.quantities[colour], range, up());

  function setColour(key) {
    colour = key;
    const q = tandem.quantities[key];
    if (!q.kinds)
      range = ranges[key] = ranges[key] || tandem.rangeOf(run, q, up());
    space.grains.repaint(paint);
    drawLegend();
    space.draw();
  }

  function element(tag, text, className) {
    const e = document.createElement(tag);
    if (text !== undefined)
      e.textContent = text;
    if (className)
      e.className = className;
    return e;
  }

  function drawLegend() {
    const legend = $('legend'), q = tandem.quantities[colour];
    legend.textContent = '';
    const swatch = (css, text, line) => {
      const row = element('span'), s = element('span', undefined, line ? 'swatch line' : 'swatch');
      s.style.background = css;
      row.append(s, ' ' + text);
      return row;
    };
    if (run.times.length && run.head(0).n + run.head(run.times.length - 1).n > 0) {
      legend.append(element('b', 'particles: ' + q.name + (q.unit ? ' [' + q.unit + ']' : '')));
      if (q.kinds) {
        const kinds = element('div', undefined, 'kinds');
        q.kinds(meta).forEach((name, k) => kinds.append(swatch(tandem.css(tandem.kinds[k % tandem.kinds.length]), name)));
        legend.append(kinds);
      } else {
        const bar = element('div', undefined, 'bar'), ends = element('div', undefined, 'ends'), stops = [];
        for (let i = 0; i < 256; i += 15)
          stops.push(tandem.css(tandem.ramp.subarray(3 * i, 3 * i + 3)));
        bar.style.background = `linear-gradient(90deg, ${stops.join(',')})`;
        range.forEach((x, side) => {
          const input = element('input');
          input.value = tandem.number(x);
          input.title = side ? 'and more; type a number to change it' : 'and less; type a number to change it';
          input.addEventListener('change', () => {
            const y = Number(input.value);
            if (Number.isFinite(y) && (side ? y > range[0] : y < range[1]))
              range[side] = y, typed.add(colour);
            setColour(colour);
          });
          ends.append(input);
        });
        legend.append(bar, ends);
      }
    }
    const kinds = element('div', undefined, 'kinds'), hex = (c) => '#' + c.toString(16).padStart(6, '0');
    const moving = space.machine.bodies.filter((b) => !b.still);
    for (const b of moving.slice(0, 8))
      kinds.append(swatch(hex(b.colour), b.name + ' (moves)'));
    if (moving.length > 8)
      kinds.append(element('span', `and ${moving.length - 8} more that move`));
    if (space.machine.bodies.some((b) => b.still && b.meshes.length))
      kinds.append(swatch('#9aa5b1', 'stands still'));
    const lines = new Map(meta.lines.map((l) => [l.kind, l.text]));
    for (const [kind, text] of lines)
      kinds.append(swatch(hex(tandem.lineColours[kind]), text, true));
    if (hasLoads)
      kinds.append(swatch(hex(tandem.loadColour), 'load of the particles, longest ' + tandem.number(mostLoad) + ' N', true));
    legend.append(kinds);
  }

  /* the longest arrow stands for the greatest load of the run */
  let hasLoads = false;
  function findLoads() {
    let most = 0;
    for (let k = 0; k < run.times.length; k++)
      most = Math.max(most, run.head(k).most.load);
    for (const b of meta.bodies)
      most = Math.max(most, curves.greatest(`body_${b.name}.csv`, ['fx', 'fy', 'fz']));
    hasLoads = most > 0;
    mostLoad = most || 1;
  }

  /* ---- what was clicked ---- */

  const vector = (v) => `${tandem.number(v[0])}, ${tandem.number(v[1])}, ${tandem.number(v[2])}`;
  const sized = (v, unit) => `${tandem.number(Math.hypot(...v))} ${unit}   (${vector(v)})`;

  function particleRows(f, r, i) {
    const half = (array, scale) => [0, 1, 2].map((c) => scale * tandem.half[array[3 * i + c]]);
    const rows = [['id', r.id[i]], ['place', vector(space.grains.place(i)) + ' m'], ['velocity', sized(half(f.velocity, f.scale[0]), 'm/s')],
                  ['contact force', sized(half(f.force, f.scale[2]), 'N')], ['angular velocity', sized(half(f.spin, f.scale[1]), 'rad/s')],
                  ['radius', tandem.length(r.radius[i])]];
    if (meta.materials.length)
      rows.push(['material', meta.materials[r.material[i]] || r.material[i]]);
    if (r.sizeClass[i] >= 0 && meta.edges.length)
      rows.push(['size class', tandem.quantities.sizeClass.kinds(meta)[r.sizeClass[i]]]);
    rows.push(['born at', vector([0, 1, 2].map((c) => r.low[c] + r.size[c] / 65535 * r.born[3 * i + c])) + ' m']);
    return rows;
  }

  function bodyRows(f, b) {
    const body = meta.bodies[b], p = Array.from(f.pose.subarray(7 * b, 7 * b + 7)), load = Array.from(f.load.subarray(3 * b, 3 * b + 3));
    const who = body.dem && body.mbd ? 'DEM and MBD (coupled)' : body.mbd ? 'MBD' : 'DEM';
    const rows = [['body', body.name], ['computed by', who], ['centre of mass', vector(p.slice(0, 3)) + ' m']];
    const angle = 2 * Math.acos(Math.min(1, Math.abs(p[3]))), s = Math.sin(0.5 * angle) || 1, turn = Math.sign(p[3]) || 1;
    rows.push(['turned by', `${tandem.number(angle * 180 / Math.PI)}° about (${vector(p.slice(4).map((x) => turn * x / s))})`]);
    const a = Math.max(0, now - 1), z = Math.min(run.times.length - 1, now + 1), span = run.times[z] - run.times[a];
    if (span > 0) {
      const before = run.frame(a).pose, after = run.frame(z).pose;
      rows.push(['velocity', sized([0, 1, 2].map((c) => (after[7 * b + c] - before[7 * b + c]) / span), 'm/s')]);
    }
    rows.push(['load of particles', Number.isFinite(load[0]) ? sized(load, 'N') : 'not known']);
    return rows;
  }

  function showPicked() {
    const info = $('info'), f = space.grains.frame || space.machine.frame, r = space.grains.roster;
    info.hidden = !picked;
    space.mark(null);
    if (!picked)
      return;
    let rows;
    if (picked.id !== undefined) {
      const i = r.id[picked.index] === picked.id ? picked.index : (picked.index = r.id.indexOf(picked.id));
      rows = i < 0 ? [['id', picked.id], ['', 'is not there at this time']] : particleRows(f, r, i);
      if (i >= 0)
        space.mark(space.grains.place(i), r.radius[i]);
    } else {
      rows = bodyRows(f, picked.body);
    }
    info.textContent = '';
    const close = element('button', '×'), table = element('table');
    close.addEventListener('click', () => pick(null));
    for (const [name, value] of rows) {
      const tr = element('tr');
      tr.append(element('td', name), element('td', value));
      table.append(tr);
    }
    info.append(close, table);
  }

  function pick(hit) {
    picked = hit && hit.particle !== undefined ? {index: hit.particle, id: space.grains.roster.id[hit.particle]} : hit;
    showPicked();
    space.draw();
  }

  /* ---- what the user does ---- */

  function wireSpace() {
    for (const key in tandem.quantities) {
      const q = tandem.quantities[key];
      if (!q.kinds || q.kinds(meta).length > 0)
        $('colour').add(new Option(q.name + (q.unit ? ' [' + q.unit + ']' : ''), key));
    }
    $('colour').addEventListener('change', (e) => setColour(e.target.value));
    const opacity = () => {
      space.machine.setOpacity(Number($('opacity').value));
      space.draw();
    };
    $('opacity').addEventListener('input', opacity);
    opacity();
    const cut = () => {
      $('cutAt').disabled = $('cutTurned').disabled = !$('cut').value;
      space.setCut($('cut').value, Number($('cutAt').value), $('cutTurned').checked);
      $('cutAt').title = $('cut').value ? `${$('cut').value} = ${tandem.number(space.cutAt)} m` : '';
    };
    for (const id of ['cut', 'cutAt', 'cutTurned'])
      $(id).addEventListener('input', cut);
    for (const button of $('looks').children)
      button.addEventListener('click', () => space.look(button.dataset.look));
    const shows = {showGrains: (on) => space.grains.setVisible(on), showLines: (on) => space.machine.setLines(on),
                   showLoads: (on) => space.machine.setLoads(on), showNames: (on) => space.names = on, showGrid: (on) => space.setGrid(on)};
    for (const id in shows)
      $(id).addEventListener('change', (e) => {
        shows[id](e.target.checked);
        space.draw();
      });
    space.machine.bodies.forEach((b, k) => {
      const label = element('label'), box = element('input');
      box.type = 'checkbox';
      box.checked = true;
      box.addEventListener('change', () => {
        space.machine.setBody(k, box.checked);
        space.draw();
      });
      label.append(box, ' ' + b.name);
      $('bodies').append(label);
    });
    let down = null;
    space.canvas.addEventListener('pointerdown', (e) => down = [e.clientX, e.clientY]);
    space.canvas.addEventListener('pointerup', (e) => {
      if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < 4 && run.times.length)
        pick(space.pick(e.clientX, e.clientY));
    });
  }

  const keys = [[' ', 'space', 'play or pause', () => setPlaying(!playing)],
                ['ArrowLeft', '←', 'one frame back (with shift: ten)', (e) => step(e.shiftKey ? -10 : -1)],
                ['ArrowRight', '→', 'one frame on (with shift: ten)', (e) => step(e.shiftKey ? 10 : 1)],
                ['Home', 'Home', 'to the start', () => step(-Infinity)], ['End', 'End', 'to the end', () => step(Infinity)],
                ['f', 'f', 'see all', () => space && space.look('space')], ['c', 'c', 'next colour', () => nextColour()],
                ['Escape', 'Esc', 'let go of what was clicked', () => space && pick(null)],
                ['h', 'h', 'this list', () => $('keys').hidden = !$('keys').hidden]];
  function step(by) {
    setPlaying(false);
    $('newest').checked = false;
    showFrame(Math.min(Math.max(now + by, 0), run.times.length - 1));
  }
  function nextColour() {
    const select = $('colour');
    if (!space)
      return;
    select.selectedIndex = (select.selectedIndex + 1) % select.length;
    setColour(select.value);
  }

  function wire() {
    $('play').addEventListener('click', () => setPlaying(!playing));
    $('back').addEventListener('click', () => step(-1));
    $('on').addEventListener('click', () => step(1));
    $('slider').addEventListener('input', () => {
      setPlaying(false);
      $('newest').checked = false;
      showFrame(Number($('slider').value));
    });
    const table = element('table');
    for (const [, name, text] of keys) {
      const tr = element('tr');
      tr.append(element('td', name), element('td', text));
      table.append(tr);
    }
    const mouse = element('tr');
    mouse.append(element('td', 'mouse'), element('td', 'left: turn; right: move; wheel: zoom; click: numbers'));
    table.append(mouse);
    $('keys').append(table);
    $('help').addEventListener('click', () => $('keys').hidden = !$('keys').hidden);
    $('choose').addEventListener('click', () => {
      $('chooser').hidden = !$('chooser').hidden;
      curves.resize();
    });
    document.addEventListener('keydown', (e) => {
      if (/^(SELECT|TEXTAREA)$/.test(e.target.tagName) || (e.target.tagName === 'INPUT' && e.target.type !== 'range' && e.target.type !== 'checkbox') || e.ctrlKey || e.metaKey)
        return;
      const key = keys.find((k) => k[0] === e.key);
      if (key) {
        e.preventDefault();
        key[3](e);
      }
    });
    window.addEventListener('resize', () => {
      if (space)
        space.resize();
      curves.resize();
    });
  }

  /* ---- a run that goes on ---- */

  const clockText = (s) => s < 100 ? Math.round(s) + ' s' : s < 6000 ? Math.round(s / 60) + ' min' : tandem.number(s / 3600) + ' h';

  function tellProgress(state) {
    const parts = [`${tandem.number(state.t)} of ${tandem.number(state.end)} s`, `${state.windows} windows`, clockText(state.wall_s)];
    if (!state.over && state.left_s !== undefined)
      parts.push('about ' + clockText(state.left_s) + ' left');
    for (const [name, text, unit] of [['balance', 'energy balance', 'J'], ['exchange', 'exchange', 'J']])
      if (Number.isFinite(curves.last('ledger.csv', name)))
        parts.push(`${text} ${tandem.number(curves.last('ledger.csv', name))} ${unit}`);
    const drift = Math.max(...curves.names('ledger.csv').filter((n) => /\.drift$/.test(n)).map((n) => curves.last('ledger.csv', n)));
    if (Number.isFinite(drift))
      parts.push('drift ' + tandem.length(drift));
    $('progress').textContent = parts.join('  ·  ');
    $('progress').hidden = false;
    $('stop').hidden = state.over;
    if (meta.status !== state.status) {
      meta.status = state.status;
      meta.error = state.error;
      tellStatus();
    }
  }

  /* Ranges and the longest arrow follow what has come; a range that was typed stays. */
  let renewed = 0;
  function takeFrame() {
    if (!space) {
      if (run.times.length === 1)
        openSpace();
      return;
    }
    const h = run.head(run.times.length - 1);
    if (h.most.load > (hasLoads ? mostLoad : 0)) {
      mostLoad = h.most.load;
      hasLoads = true;
      drawLegend();
    }
    if (performance.now() - renewed > 1000 && !document.activeElement.closest('#legend')) {
      renewed = performance.now();
      for (const key in ranges)
        if (!typed.has(key))
          delete ranges[key];
      setColour(colour);
    }
    if ($('newest').checked && !playing)
      showFrame(run.times.length - 1);
    else
      tellTime();
  }

  function watch() {
    $('newestLabel').hidden = false;
    $('newest').addEventListener('change', () => $('newest').checked && showFrame(run.times.length - 1));
    $('stop').addEventListener('click', () => {
      $('stop').disabled = true;
      run.stop();
    });
    run.begin({
      frame: takeFrame, state: tellProgress,
      channels: () => {
        const hidden = $('side').hidden;
        $('side').hidden = meta.channels.length === 0;
        curves.renew();
        if (space) {
          findLoads();
          drawLegend();
        }
        if (space && hidden && !$('side').hidden) { /* the picture has become narrower */
          space.resize();
          space.look('space');
        }
        tellTime();
      },
      lost: () => {
        meta.status = 'lost';
        $('stop').hidden = true;
        meta.notes = ['The run does not answer any more: it has ended, or was ended. What was seen of it stays here; the result directory has the rest.'];
        tellStatus();
      },
    });
  }

  /* ---- start ---- */

  function openSpace() {
    if (!run.times.length) {
      $('nothing').hidden = false;
      $('nothing').textContent = meta.live ? 'Waiting for the first frame ...' : 'There are no frames to show.';
      for (const id of ['controls', 'legend'])
        $(id).hidden = true;
      return;
    }
    try {
      space = new tandem.Space($('space'), $('over'), run);
    } catch (e) {
      $('nothing').hidden = false;
      $('nothing').textContent = 'This browser cannot draw in space (WebGL): ' + e.message;
      return;
    }
    for (const id of ['controls', 'legend', 'nothing'])
      $(id).hidden = id === 'nothing';
    findLoads();
    wireSpace();
    space.resize();
    space.look('space');
    showFrame(run.times.length && meta.live ? run.times.length - 1 : 0);
    setColour(run.head(0).n || run.head(run.times.length - 1).n ? 'speed' : 'height');
  }

  /* Frames a second of a playback as fast as it goes, each one drawn to its end: {frames, seconds, rate}. */
  tandem.benchmark = (frames = 60) => new Promise((done) => {
    const gl = space.renderer.getContext(), pixel = new Uint8Array(4);
    let i = 0, begin = 0;
    const next = () => {
      if (i === 0)
        begin = performance.now();
      if (i === frames) {
        const seconds = (performance.now() - begin) / 1000;
        done({frames, seconds, rate: frames / seconds});
        return;
      }
      showFrame(i++ % run.times.length);
      space.drawNow();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  });
  /* for tests, and for scripts of the user's own */
  tandem.show = showFrame;
  tandem.state = () => ({frame: now, frames: run.times.length, time: run.times[now], playing, colour, picked});
  tandem.where = (i) => space.project(space.grains.place(i));
  tandem.whereBody = (k) => space.project(space.machine.bodies[k].group.position.toArray());
  tandem.draw = () => space.drawNow(true);
  tandem.run = run;
  tandem.place = (i) => space.grains.place(i);

  tellStatus();
  tellTrust();
  wire();
  offerSpeeds();
  curves = new tandem.Curves(run, $('list'), $('filter'), $('stack'), (time) => {
    setPlaying(false);
    showFrame(frameAt(time));
  });
  openSpace();
  $('side').hidden = curves.count === 0;
  if (space)
    space.resize();
  tellTime();
  if (meta.live)
    watch();
})(window.tandem);
