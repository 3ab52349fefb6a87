/* A run that goes on: its frames come from the server that the page came from (coupler/live/server.h). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
(function (tandem) {
  'use strict';

  const KEPT_MOST = 400e6; /* of frames [bytes]; beyond, every second one of the older half goes */

  /* The same as pageRun, with `begin(on)`: on.frame() after each new frame, on.state(state), on.channels(), on.lost(). */
  tandem.liveRun = function (meta, polygons) {
    let frames = [], kept = 0, number = 0, channels = [], over = false;
    const rosters = new Map(), run = {meta, polygons, times: []};
    run.frame = (k) => frames[k];
    run.head = (k) => frames[k];
    run.roster = (serial) => rosters.get(serial);
    run.channels = (k) => channels[k];

    function thin() {
      const half = Math.floor(frames.length / 2);
      frames = frames.filter((f, k) => k >= half || k % 2 === 0);
      run.times = frames.map((f) => f.time);
      kept = frames.reduce((sum, f) => sum + f.position.buffer.byteLength, 0);
      const used = new Set(frames.map((f) => f.roster));
      for (const serial of rosters.keys())
        if (!used.has(serial))
          rosters.delete(serial);
    }

    async function getFrame(on) {
      const answer = await fetch('/frame?after=' + number);
      if (answer.status !== 200)
        return answer.status === 204;
      const buffer = await answer.arrayBuffer(), view = new DataView(buffer), size = view.getUint32(4, true);
      number = view.getUint32(0, true);
      const frame = tandem.unpackFrame(buffer.slice(8 + size));
      if (!rosters.has(frame.roster))
        rosters.set(frame.roster, tandem.unpackRoster(buffer.slice(8, 8 + size)));
      frames.push(frame);
      run.times.push(frame.time);
      kept += frame.position.buffer.byteLength;
      if (kept > KEPT_MOST)
        thin();
      on.frame();
      return true;
    }

    async function getChannels(on) {
      const answer = await fetch('/channels');
      if (answer.status !== 200)
        return;
      const buffer = await answer.arrayBuffer(), view = new DataView(buffer);
      let at = 0;
      const next = () => {
        const size = view.getUint32(at, true), bytes = buffer.slice(at + 4, at + 4 + size);
        at += 4 + size;
        return bytes;
      };
      meta.channels = JSON.parse(new TextDecoder().decode(next()));
      channels = meta.channels.map(() => tandem.unpackChannels(next()));
      on.channels();
    }

    async function getState(on) {
      const answer = await fetch('/state');
      if (answer.status !== 200)
        return;
      const state = await answer.json();
      const last = state.over && !over;
      over = over || state.over;
      on.state(state); /* how it ended is told even when the rest does not come */
      if (last) {
        await getFrame(on);
        await getChannels(on);
        on.state(state);
      }
    }

    /* again and again, each so long after it was done */
    function repeat(what, pause, on) {
      const again = async () => {
        if (over)
          return;
        try {
          await what(on);
        } catch (e) {
          if (!over)
            on.lost(e);
          over = true;
        }
        if (!over)
          setTimeout(again, pause);
      };
      again();
    }

    run.begin = function (on) {
      repeat(getFrame, 50, on);
      repeat(getState, 300, on);
      repeat(getChannels, 1500, on);
    };
    run.stop = () => fetch('/stop', {method: 'POST'});
    return run;
  };
})(window.tandem);
