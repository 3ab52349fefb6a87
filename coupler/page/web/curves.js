/* The time histories beside the picture: chosen channels, a panel each, with a cursor at the time that is shown. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
(function (tandem) {
  'use strict';

  const HEIGHT_LEAST = 92, CHOSEN_AT_FIRST = 5;

  /* The columns of all files: {key, file, name, unit, of: file number, column}. */
  function channelsOf(run) {
    const all = [];
    run.meta.channels.forEach((file, of) => (file.names || []).forEach((head, column) => {
      const m = /^(.*?)\s*\[(.*)\]$/.exec(head), name = m ? m[1] : head, unit = m ? m[2] : '';
      const stem = file.file.replace(/\.csv$/, ''), body = /^body_(.*)$/.exec(stem);
      const label = body ? body[1] + '.' + name : stem === 'channels' ? name : stem + ': ' + name;
      all.push({key: file.file + '/' + name, label, file: file.file, name, unit: unit === '1' || unit === '-' ? '' : unit, of, column});
    }));
    return all;
  }

  function extent(values) {
    let low = Infinity, high = -Infinity;
    for (const v of values)
      if (Number.isFinite(v)) {
        low = Math.min(low, v);
        high = Math.max(high, v);
      }
    return [low, high];
  }

  tandem.Curves = function (run, list, filter, stack, onTime) {
    const chosen = new Set(), data = [];
    let channels = channelsOf(run), time = 0, panels = [];
    const dataOf = (of) => data[of] = data[of] || run.channels(of);
    const values = (c) => dataOf(c.of).column[c.column] || new Float32Array(0);
    const changes = (c) => {
      const [low, high] = extent(values(c));
      return high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high));
    };

    /* What a newcomer looks at: of each coupled body the place and the force that change most, then solvers' channels. */
    function chooseAtFirst() {
      const most = (file, names) => {
        const width = (c) => {
          const [low, high] = extent(values(c));
          return high - low;
        };
        return channels.filter((c) => c.file === file && names.includes(c.name) && changes(c)).sort((a, b) => width(b) - width(a))[0];
      };
      const wanted = [];
      for (const f of run.meta.channels)
        if (/^body_/.test(f.file))
          wanted.push(most(f.file, ['x', 'y', 'z']), most(f.file, ['vx', 'vy', 'vz']), most(f.file, ['fx', 'fy', 'fz']));
      wanted.push(...channels.filter((c) => /^(balance|screening\.(efficiency|out)|particles\.(count|kinetic_energy|mass)|energy\.kinetic)$/.test(c.name) && changes(c)));
      wanted.push(...channels.filter((c) => !/^(body_|ledger)/.test(c.file) && changes(c)));
      for (const c of wanted)
        if (c && chosen.size < CHOSEN_AT_FIRST)
          chosen.add(c.key);
    }

    function buildList() {
      const word = filter.value.toLowerCase();
      list.textContent = '';
      let file = null;
      for (const c of channels) {
        if (word && !(c.label + ' ' + c.unit).toLowerCase().includes(word))
          continue;
        if (c.file !== file) {
          file = c.file;
          const head = document.createElement('h3');
          head.textContent = file;
          list.append(head);
        }
        const label = document.createElement('label'), box = document.createElement('input');
        box.type = 'checkbox';
        box.checked = chosen.has(c.key);
        box.addEventListener('change', () => {
          if (box.checked)
            chosen.add(c.key);
          else
            chosen.delete(c.key);
          build();
        });
        label.append(box, ' ' + c.name + (c.unit ? ' [' + c.unit + ']' : ''));
        if (!changes(c))
          label.className = 'constant', label.title = 'does not change';
        list.append(label);
      }
    }

    function build() {
      stack.textContent = '';
      panels = channels.filter((c) => chosen.has(c.key)).map((channel) => {
        const panel = document.createElement('div'), head = document.createElement('div'), canvas = document.createElement('canvas');
        panel.className = 'curve';
        head.className = 'head';
        head.innerHTML = '<span></span><output></output><button title="Leave this curve out">×</button>';
        head.firstChild.textContent = channel.label + (channel.unit ? ' [' + channel.unit + ']' : '');
        head.lastChild.addEventListener('click', () => {
          chosen.delete(channel.key);
          build();
          buildList();
        });
        panel.append(head, canvas);
        stack.append(panel);
        const jump = (e) => {
          const rect = canvas.getBoundingClientRect(), p = panels.find((q) => q.canvas === canvas);
          onTime(p.t0 + (p.t1 - p.t0) * (e.clientX - rect.left - p.left) / (rect.width - p.left - 8));
        };
        canvas.addEventListener('pointerdown', (e) => {
          canvas.setPointerCapture(e.pointerId);
          jump(e);
        });
        canvas.addEventListener('pointermove', (e) => e.buttons && jump(e));
        return {channel, canvas, value: head.children[1], left: 58};
      });
      this_.resize();
    }

    /* the two ends and the round steps between them */
    function ticks(low, high, most) {
      const rough = (high - low) / most, p = 10 ** Math.floor(Math.log10(rough));
      const step = p * (rough / p > 5 ? 10 : rough / p > 2 ? 5 : rough / p > 1 ? 2 : 1), out = [];
      for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step && out.length < 20; k++)
        out.push(k * step);
      return out;
    }

    function plot(p, last) {
      const ratio = window.devicePixelRatio || 1, width = p.canvas.clientWidth, height = p.canvas.clientHeight;
      const c = p.plain.getContext('2d', {willReadFrequently: true}), t = dataOf(p.channel.of).time, v = values(p.channel);
      let [low, high] = extent(v);
      const ends = [t.length ? t[0] : 0, t.length ? t[t.length - 1] : 1], frames = run.times;
      p.t0 = Math.min(ends[0], frames.length ? frames[0] : ends[0]);
      p.t1 = Math.max(ends[1], frames.length ? frames[frames.length - 1] : ends[1], p.t0 + 1e-9);
      if (!(high >= low))
        low = 0, high = 1;
      const pad = 0.06 * (high - low) || 0.06 * Math.abs(high) || 1;
      p.low = low - pad, p.high = high + pad;
      const bottom = height - (last ? 16 : 5), right = width - 8;
      p.x = (time) => p.left + (time - p.t0) / (p.t1 - p.t0) * (right - p.left);
      p.y = (value) => bottom - (value - p.low) / (p.high - p.low) * (bottom - 4);
      c.setTransform(ratio, 0, 0, ratio, 0, 0);
      c.clearRect(0, 0, width, height);
      c.font = '11px system-ui, sans-serif';
      c.fillStyle = '#5a6675';
      c.strokeStyle = '#e1e6ec';
      c.lineWidth = 1;
      c.textAlign = 'right';
      c.textBaseline = 'middle';
      for (const y of ticks(p.low, p.high, Math.max(2, height / 34))) {
        c.fillText(tandem.number(y), p.left - 5, p.y(y));
        c.beginPath();
        c.moveTo(p.left, Math.round(p.y(y)) + 0.5);
        c.lineTo(right, Math.round(p.y(y)) + 0.5);
        c.stroke();
      }
      c.textAlign = 'center';
      c.textBaseline = 'alphabetic';
      for (const x of ticks(p.t0, p.t1, 5)) {
        if (last)
          c.fillText(tandem.number(x) + ' s', Math.min(p.x(x), right - 12), height - 2);
        c.beginPath();
        c.moveTo(Math.round(p.x(x)) + 0.5, 4);
        c.lineTo(Math.round(p.x(x)) + 0.5, bottom);
        c.stroke();
      }
      c.strokeStyle = '#1f5fa8';
      c.lineWidth = 1.3;
      c.lineJoin = 'round';
      c.beginPath();
      let pen = false;
      for (let i = 0; i < t.length; i++) {
        if (!Number.isFinite(v[i])) {
          pen = false;
          continue;
        }
        c[pen ? 'lineTo' : 'moveTo'](p.x(t[i]), p.y(v[i]));
        pen = true;
      }
      c.stroke();
    }

    /* the row that is nearest before a time */
    function rowAt(t, when) {
      let a = 0, b = t.length - 1;
      while (a < b) {
        const m = (a + b + 1) >> 1;
        if (t[m] <= when + 1e-7 * Math.abs(when))
          a = m;
        else
          b = m - 1;
      }
      return a;
    }

    function cursor(p) {
      const ratio = window.devicePixelRatio || 1, c = p.canvas.getContext('2d', {willReadFrequently: true}), height = p.canvas.clientHeight;
      const t = dataOf(p.channel.of).time, v = values(p.channel), x = p.x(Math.min(Math.max(time, p.t0), p.t1));
      c.setTransform(1, 0, 0, 1, 0, 0);
      c.clearRect(0, 0, p.canvas.width, p.canvas.height);
      c.drawImage(p.plain, 0, 0);
      c.setTransform(ratio, 0, 0, ratio, 0, 0);
      c.strokeStyle = '#d41f3a';
      c.lineWidth = 1.2;
      c.beginPath();
      c.moveTo(x, 2);
      c.lineTo(x, height - 4);
      c.stroke();
      const value = t.length ? v[rowAt(t, time)] : NaN;
      p.value.textContent = tandem.number(value);
      if (Number.isFinite(value)) {
        c.fillStyle = '#d41f3a';
        c.beginPath();
        c.arc(x, p.y(value), 3, 0, 7);
        c.fill();
      }
    }

    const this_ = this;
    this.count = channels.length;
    this.resize = function () {
      const ratio = window.devicePixelRatio || 1;
      const height = Math.max(HEIGHT_LEAST, Math.floor(stack.clientHeight / Math.max(1, panels.length)) - 30);
      panels.forEach((p, k) => {
        p.canvas.style.height = Math.min(height, 220) + 'px';
        p.canvas.width = p.canvas.clientWidth * ratio;
        p.canvas.height = p.canvas.clientHeight * ratio;
        p.plain = document.createElement('canvas');
        p.plain.width = p.canvas.width;
        p.plain.height = p.canvas.height;
        if (p.canvas.width > 0)
          plot(p, k === panels.length - 1), cursor(p);
      });
    };
    this.setTime = function (t) {
      time = t;
      for (const p of panels)
        if (p.plain && p.canvas.width > 0)
          cursor(p);
    };
    /* The run has gone on: rows are read anew, and files that are new are there to choose from. */
    this.renew = function () {
      const before = channels.length;
      data.length = 0;
      channels = channelsOf(run);
      this.count = channels.length;
      if (chosen.size === 0)
        chooseAtFirst();
      if (channels.length !== before)
        buildList();
      if (panels.length !== chosen.size)
        build();
      else
        this.resize();
    };
    /* the last value of a column, NaN: there is none */
    this.last = function (file, name) {
      const c = channels.find((x) => x.file === file && x.name === name), v = c ? values(c) : [];
      return v.length ? v[v.length - 1] : NaN;
    };
    /* the columns' values at a time, of the row before it, and the greatest length of the vector that they are */
    const columns = (file, names) => names.map((name) => channels.find((c) => c.file === file && c.name === name));
    this.at = function (file, names, when) {
      const found = columns(file, names), t = found[0] ? dataOf(found[0].of).time : [];
      return found.map((c) => c && t.length ? values(c)[rowAt(t, when)] : NaN);
    };
    this.greatest = function (file, names) {
      const found = columns(file, names).filter((c) => c).map(values);
      let most = 0;
      for (let i = 0; found.length && i < found[0].length; i++)
        most = Math.max(most, Math.hypot(...found.map((v) => v[i])) || 0);
      return most;
    };
    this.names = (file) => channels.filter((c) => c.file === file).map((c) => c.name);

    filter.addEventListener('input', buildList);
    chooseAtFirst();
    buildList();
    build();
  };
})(window.tandem);
