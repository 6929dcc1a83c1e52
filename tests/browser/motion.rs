//! Animation of the gearbox: motion and stops, cost of a frame in the browser, no work while invisible. Work is counted,
//! not timed.

use std::path::Path;

use serde_json::Value;

use crate::chromium::{Chromium, DESK, Look, PHONE};

/// Reader without a preference for less motion, on a small screen: without a graphics card its frames take a third of the
/// time.
const MOVING: Look = Look {
    still: false,
    ..PHONE
};

/// The gearbox moves, stops at a click, moves at a key, and waits if the reader prefers less motion.
pub(crate) fn moves(browser: &mut Chromium, page: &Path) {
    const WATCH: &str = r#"(async () => {
      const host = document.querySelector('.gearboxes');
      const wait = (ms) => new Promise((r) => setTimeout(r, ms));
      const at = () => host.querySelector('.at').textContent;
      const moving = async () => { const before = at(); for (let k = 0; k < most && at() === before; k += 1) await wait(25); return at() !== before; };
      const most = matchMedia('(prefers-reduced-motion: reduce)').matches ? 24 : 80;
      for (let k = 0; k < 200 && !('ready' in host.dataset); k += 1) await wait(25);
      host.scrollIntoView();
      const began = await moving();
      if (most < 80) return [began];
      host.querySelector('.play').click();
      const paused = at(); await wait(250);
      const stopped = at() === paused;
      const key = (k) => host.querySelector('canvas').dispatchEvent(new KeyboardEvent('keydown', { key: k, bubbles: true }));
      key('ArrowRight');
      const stepped = at() !== paused;
      const slider = host.querySelector('input[type=range]');
      slider.value = '0';
      slider.dispatchEvent(new Event('input'));
      const slid = at() === 't = 0.0000 s';
      key(' ');
      const again = await moving();
      return [began, stopped, stepped, slid, again];
    })()"#;
    let mut watch = |still: bool| {
        browser.open(page, Look { still, ..PHONE });
        let states = browser.evaluate(WATCH);
        browser.assert_quiet();
        let states = states.as_array().unwrap().iter();
        states.map(|v| v.as_bool().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(
        watch(false),
        [true; 5],
        "began, stopped, stepped, slid, began again"
    );
    assert!(
        !watch(true)[0],
        "it moves although less motion was asked for"
    );
}

/// Counts the page's requests to the browser: `count` since the start, `frames` for each frame.
const COUNT: &str = r#"(() => {
  const count = { points: 0, paints: 0, paths: 0, texts: 0, reads: 0, requests: 0, changes: 0 };
  const frames = [];
  const tap = (owner, name, what) => {
    const original = owner[name];
    owner[name] = function (...given) { count[what] += 1; return original.apply(this, given); };
  };
  for (const name of ['moveTo', 'lineTo', 'arc', 'arcTo', 'ellipse', 'rect', 'roundRect', 'bezierCurveTo', 'quadraticCurveTo']) {
    tap(CanvasRenderingContext2D.prototype, name, 'points');
    tap(Path2D.prototype, name, 'points');
  }
  for (const name of ['fill', 'stroke', 'fillRect', 'strokeRect', 'clearRect', 'drawImage', 'putImageData']) tap(CanvasRenderingContext2D.prototype, name, 'paints');
  for (const name of ['fillText', 'strokeText', 'measureText']) tap(CanvasRenderingContext2D.prototype, name, 'texts');
  for (const name of ['Path2D', 'DOMMatrix', 'OffscreenCanvas']) {
    window[name] = new Proxy(window[name], { construct(kind, given) { count.paths += 1; return new kind(...given); } });
  }
  // Reads that force the browser to lay out or style the page at once.
  for (const name of ['getBoundingClientRect', 'getClientRects']) tap(Element.prototype, name, 'reads');
  tap(window, 'getComputedStyle', 'reads');
  for (const [owner, names] of [[Element.prototype, ['clientWidth', 'clientHeight', 'scrollTop', 'scrollWidth']], [HTMLElement.prototype, ['offsetWidth', 'offsetHeight', 'offsetLeft', 'offsetTop', 'innerText']]]) {
    for (const name of names) {
      const { get, ...rest } = Object.getOwnPropertyDescriptor(owner, name);
      Object.defineProperty(owner, name, { ...rest, get() { count.reads += 1; return get.call(this); } });
    }
  }
  new MutationObserver(() => { count.changes += 1; }).observe(document.body, { subtree: true, childList: true, characterData: true, attributes: true });
  const request = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (callback) => {
    count.requests += 1;
    return request((stamp) => {
      const before = { ...count };
      callback(stamp);
      const frame = {};
      for (const key of Object.keys(count)) frame[key] = count[key] - before[key];
      frames.push(frame);
    });
  };
  window.counted = { count, frames };
  document.querySelector('.gearboxes').scrollIntoView({ block: 'start' });
})()"#;

/// Resolves after this number of drawn frames.
const FRAMES: &str = r#"(async () => {
  const { count, frames } = window.counted;
  const wait = (ms) => new Promise((r) => setTimeout(r, ms));
  // Sizes and sharpness settle first.
  for (let k = 0; k < 12000 && frames.length < 20; k += 1) await wait(10);
  frames.length = 0;
  count.changes = 0;
})()"#;
const THESE: &str = r#"(async () => {
  const { count, frames } = window.counted;
  const wait = (ms) => new Promise((r) => setTimeout(r, ms));
  for (let k = 0; k < 12000 && frames.length < 20; k += 1) await wait(10);
  const most = (key) => Math.max(...frames.map((f) => f[key]));
  return {
    frames: frames.length, changes: count.changes,
    points: most('points'), paints: most('paints'), paths: most('paths'), texts: most('texts'), reads: most('reads'), requests: most('requests'),
    idle: frames.filter((f) => f.paints === 0).length,
  };
})()"#;

/// A frame takes a bounded number of pen strokes, makes no path, and reads no layout.
pub(crate) fn frames_cost_little(browser: &mut Chromium, page: &Path) {
    browser.open(
        page,
        Look {
            still: false,
            ..DESK
        },
    );
    browser.evaluate(COUNT);
    browser.evaluate(FRAMES);
    let before = browser.metrics();
    let cost = browser.evaluate(THESE);
    let after = browser.metrics();
    let number = |key: &str| cost[key].as_f64().unwrap();
    let frames = number("frames");
    let spent = |key: &str| after[key] - before[key];
    assert!(frames >= 20.0, "it does not play: {cost}");
    assert_eq!(number("idle"), 0.0, "every frame is drawn: {cost}");
    assert_eq!(number("requests"), 1.0, "a frame asks for one more: {cost}");
    for key in ["paths", "texts", "reads"] {
        assert_eq!(number(key), 0.0, "{key}: {cost}");
    }
    // Two discs, 8 + 16 pins, at most 32 forces: measured 407 points and 58 strokes; with paths built in every frame and
    // separate drawing of every part 212 strokes, 4 paths and 3 size queries.
    assert!(number("points") < 600.0, "{cost}");
    assert!(number("paints") < 90.0, "{cost}");
    // Text changes ten times a second, and other frames cause no layout.
    assert!(
        spent("LayoutCount") <= number("changes") + 3.0,
        "{} layouts, {cost}",
        spent("LayoutCount")
    );
    browser.assert_quiet();
}

/// The gearbox requests no frame while paused, scrolled away or in a hidden tab; in view again it continues from its time.
pub(crate) fn nothing_is_drawn_unseen(browser: &mut Chromium, page: &Path) {
    const WATCH: &str = r#"(async () => {
      const { count } = window.counted;
      const host = document.querySelector('.gearboxes');
      const wait = (ms) => new Promise((r) => setTimeout(r, ms));
      // Scrolling may take a while; afterwards no frame may be requested during the time of many frames.
      const quiet = async () => { for (let k = 0; k < 70; k += 1) { const before = count.requests; await wait(120); if (count.requests === before) return true; } return false; };
      const busy = async () => { const before = count.requests; for (let k = 0; k < 500 && count.requests < before + 5; k += 1) await wait(10); return count.requests >= before + 5; };
      const hide = (on) => {
        Object.defineProperty(document, 'hidden', { configurable: true, get: () => on });
        document.dispatchEvent(new Event('visibilitychange'));
      };
      const states = { began: await busy() };
      host.querySelector('.play').click();
      states.paused = await quiet();
      host.querySelector('.play').click();
      host.querySelector('.play').click();
      host.querySelector('.play').click();
      states.went_on = await busy();
      scrollTo(0, document.body.scrollHeight);
      states.away = await quiet();
      host.scrollIntoView();
      states.back = await busy();
      hide(true);
      states.hidden = await quiet();
      hide(false);
      states.shown = await busy();
      return states;
    })()"#;
    browser.open(page, MOVING);
    browser.evaluate(COUNT);
    let states = browser.evaluate(WATCH);
    let all = states.as_object().unwrap();
    assert_eq!(all.len(), 7);
    assert!(all.values().all(|v| *v == Value::Bool(true)), "{states}");
}

/// With late frames on a fine screen the gearbox is drawn with fewer pixels in motion, and with all of them at rest.
pub(crate) fn late_frames_cost_sharpness(browser: &mut Chromium, page: &Path) {
    // The clock belongs to the test: frames 40 ms apart on any machine.
    const WATCH: &str = r#"(async () => {
      const host = document.querySelector('.gearboxes');
      const canvas = host.querySelector('.gearbox-view canvas');
      const wait = (ms) => new Promise((r) => setTimeout(r, ms));
      Object.defineProperty(window, 'devicePixelRatio', { configurable: true, get: () => 2 });
      let [stamp, drawn] = [1e6, 0];
      window.requestAnimationFrame = (callback) => setTimeout(() => { stamp += 40; drawn += 1; callback(stamp); }, 0);
      host.scrollIntoView();
      for (let k = 0; k < 2400 && drawn < 30; k += 1) await wait(10);
      const wide = Math.round(canvas.clientWidth);
      const playing = canvas.width;
      host.querySelector('.play').click();
      const resting = canvas.width;
      host.querySelector('.play').click();
      return [drawn >= 30, playing / wide, resting / wide, canvas.width / wide];
    })()"#;
    browser.open(page, MOVING);
    assert_eq!(browser.evaluate(WATCH), serde_json::json!([true, 1, 2, 1]));
    browser.assert_quiet();
}
