//! Use of a comparison's page by mouse, finger and keys.

use std::path::Path;

use serde_json::{Value, json};

use crate::chromium::{Chromium, DESK, PHONE};

/// Waits until the chart is drawn.
pub(crate) const DRAWN: &str = "(async () => { for (let k = 0; k < 200 && !document.body.dataset.drawn; k += 1) await new Promise((r) => setTimeout(r, 25)); return document.body.dataset.drawn || ''; })()";

/// Returns centre and size of an element, or of the first line of wrapped text, scrolled into view.
pub(crate) fn place(browser: &mut Chromium, element: &str) -> [f64; 4] {
    // Elements above may still be drawn and move it, so the position is read at rest.
    let script = format!(
        "(async () => {{ const e = {element}; let before = ''; for (let k = 0; k < 150; k += 1) {{ e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
         const b = e.getClientRects()[0] || new DOMRect(); const now = [b.x + b.width / 2, b.y + b.height / 2, b.width, b.height]; \
         if (b.width && now.join() === before) return now; before = now.join(); await new Promise((r) => setTimeout(r, 16)); }} }})()"
    );
    let bounds = browser.evaluate(&script);
    [0, 1, 2, 3].map(|k| bounds[k].as_f64().unwrap())
}

pub(crate) fn click(browser: &mut Chromium, element: &str) {
    let [x, y, ..] = place(browser, element);
    browser.mouse(&[("mousePressed", x, y), ("mouseReleased", x, y)], 1);
}

/// Labels of the pressed window buttons, and the displayed part of the curves.
const WINDOW: &str = "[...document.querySelectorAll('#windows [aria-pressed=true]')].map((b) => b.textContent).join()";
const OVER: &str = "document.querySelector('#chart .u-over')";
const TIP: &str = "(() => { const t = document.querySelector('#chart .tip'); return t.hidden ? '' : t.textContent; })()";

/// Zoom by dragging, full range at a double click, values at the cursor, engines on and off, other quantities and scales.
pub(crate) fn charts_answer(browser: &mut Chromium, page: &Path) {
    browser.open(page, DESK);
    assert_eq!(browser.text(DRAWN), "Ring pin force no. 0");
    // A window may be as long as the run.
    let all = browser.text(WINDOW);
    assert!(all.starts_with("all"), "{all}");
    let [x, y, wide, _] = place(browser, OVER);
    // Values at the cursor, both engines.
    browser.mouse(&[("mouseMoved", x, y), ("mouseMoved", x + 3.0, y)], 0);
    let tip = browser.text(TIP);
    assert!(
        tip.starts_with("t = ") && tip.contains("native-reduced"),
        "{tip}"
    );
    assert!(
        tip.contains("native-lagrange") && tip.contains('\u{394}'),
        "{tip}"
    );
    let near = browser.evaluate(&format!(
        "(() => {{ const b = document.querySelector('#chart .tip').getBoundingClientRect(); return Math.min(Math.abs(b.left - {x}), Math.abs(b.right - {x})); }})()"
    ));
    assert!(
        near.as_f64().unwrap() < 60.0,
        "the values stand {near} px from the cursor"
    );
    // A drag zooms both charts.
    let (from, to) = (x - 0.2 * wide, x + 0.1 * wide);
    let drag = [
        ("mousePressed", from, y),
        ("mouseMoved", x, y),
        ("mouseMoved", to, y),
        ("mouseReleased", to, y),
    ];
    browser.mouse(&drag, 1);
    assert_eq!(browser.text(WINDOW), "", "a drag did not zoom");
    browser.mouse(&[("mousePressed", x, y), ("mouseReleased", x, y)], 1);
    browser.mouse(&[("mousePressed", x, y), ("mouseReleased", x, y)], 2);
    assert_eq!(browser.text(WINDOW), all, "a double click shows all");
    click(browser, "document.querySelector('[data-zoom=in]')");
    assert_eq!(browser.text(WINDOW), "");
    click(browser, "document.querySelector('#windows button')");
    assert_eq!(browser.text(WINDOW), all);
    // One engine less.
    click(browser, "document.querySelectorAll('#legend .chip')[1]");
    let [x, y, ..] = place(browser, OVER);
    browser.mouse(&[("mouseMoved", x + 9.0, y), ("mouseMoved", x, y)], 0);
    let tip = browser.text(TIP);
    assert!(
        tip.contains("native-reduced") && !tip.contains("native-lagrange"),
        "{tip}"
    );
    // Another quantity, another pin, signed differences to the other engine.
    let choose = |id: &str, value: usize| {
        format!(
            "(async () => {{ delete document.body.dataset.drawn; const s = document.getElementById('{id}'); s.value = '{value}'; s.dispatchEvent(new Event('change')); \
             for (let k = 0; k < 100 && !document.body.dataset.drawn; k += 1) await new Promise((r) => setTimeout(r, 20)); return document.body.dataset.drawn; }})()"
        )
    };
    assert_eq!(browser.text(&choose("quantity", 3)), "Ring pin force no. 0");
    assert_eq!(browser.text(&choose("channel", 5)), "Ring pin force no. 5");
    let [x, y, ..] = place(browser, OVER);
    browser.mouse(&[("mouseMoved", x + 9.0, y), ("mouseMoved", x, y)], 0);
    let tip = browser.text(TIP);
    assert!(
        tip.contains("native-reduced") && !tip.contains("native-lagrange"),
        "the other engine is back: {tip}"
    );
    browser.evaluate("(() => { const s = document.getElementById('base'); s.value = '1'; s.dispatchEvent(new Event('change')); })()");
    click(browser, "document.querySelector('[data-scale=linear]')");
    let title = browser.text("(async () => { const title = () => document.querySelector('.plot-title').textContent; for (let k = 0; k < 100 && !title().endsWith('lagrange'); k += 1) await new Promise((r) => setTimeout(r, 10)); return title(); })()",
    );
    assert_eq!(title, "Difference to native-lagrange");
    browser.assert_quiet();
}

/// A chart by its menu: the picture as SVG and PNG, the values as CSV.
pub(crate) fn charts_are_saved(browser: &mut Chromium, page: &Path) {
    browser.open(page, DESK);
    browser.evaluate(DRAWN);
    browser.evaluate("window.files = []; URL.createObjectURL = (blob) => { files.push(blob); return '#'; }; HTMLAnchorElement.prototype.click = function () { files.at(-1).named = this.download; }; 0");
    for k in 0..3 {
        click(browser, "document.querySelector('#chart .export summary')");
        let button = format!("document.querySelectorAll('#chart .export button')[{k}]");
        click(browser, &button);
        // The menu closes after the file: a click before would close it again.
        browser.evaluate("(async () => { for (let k = 0; k < 500 && document.querySelector('#chart .export').open; k += 1) await new Promise((r) => setTimeout(r, 10)); })()");
    }
    let saved = browser.evaluate(
        "(async () => { for (let k = 0; k < 100 && files.length < 3; k += 1) await new Promise((r) => setTimeout(r, 50)); \
         const [svg, png, csv] = ['svg', 'png', 'csv'].map((kind) => files.find((file) => file.named.endsWith(kind))); const image = await createImageBitmap(png); \
         const picture = new DOMParser().parseFromString(await svg.text(), 'image/svg+xml'); \
         const curves = [...picture.querySelectorAll('g > g > path')].map((path) => path.getAttribute('d').length > 200); \
         return { curves, wide: [picture.documentElement.getAttribute('width') * 3, image.width], \
         texts: picture.querySelectorAll('text').length, csv: (await csv.text()).split('\\n') }; })()",
    );
    assert_eq!(saved["curves"], json!([true, true]), "{saved}");
    assert_eq!(saved["wide"][0], saved["wide"][1]);
    assert!(saved["texts"].as_u64().unwrap() > 10, "{saved}");
    let head = "Time (s),native-reduced: Ring pin force (N),native-lagrange: Ring pin force (N)";
    assert_eq!(saved["csv"][0], head);
    let rows = saved["csv"].as_array().unwrap();
    let complete = |row: &Value| {
        let cells = row.as_str().unwrap().split(',');
        cells.filter(|cell| cell.parse::<f64>().is_ok()).count() == 3
    };
    assert!(
        rows.len() > 100 && rows[1..rows.len() - 1].iter().all(complete),
        "{rows:?}"
    );
    browser.assert_quiet();
}

/// Everything by keys: values, zoom, the gearbox's slider, folded pairs; and links that open what they lead to.
pub(crate) fn keys_do_it_all(browser: &mut Chromium, page: &Path) {
    browser.open(page, DESK);
    browser.evaluate(DRAWN);
    browser.evaluate("document.querySelector('#chart .plot').focus()");
    browser.key("ArrowRight");
    let text = browser.text("document.querySelector('#chart .plot + .unseen').textContent");
    assert!(text.contains("native-reduced"), "not announced: {text}");
    browser.key("+");
    assert_eq!(browser.text(WINDOW), "");
    browser.key("0");
    assert!(browser.text(WINDOW).starts_with("all"));
    browser.key("Escape");
    assert_eq!(browser.text(TIP), "");
    // Time of the gearbox.
    let at = "document.querySelector('.gearboxes .at').textContent";
    let before = browser.text(at);
    browser.evaluate("document.querySelector('.gearbox-time input').focus()");
    browser.key("ArrowRight");
    assert_ne!(browser.text(at), before, "the slider does not move by keys");
    // A cell of a matrix opens its pair with its folded parents.
    let open = "[...document.querySelectorAll('.item')].filter((p) => p.open).length";
    assert_eq!(browser.evaluate(open), json!(0), "what passed is folded");
    browser.evaluate("document.querySelector('[id^=track] td.map a').focus()");
    browser.key("Enter");
    assert_eq!(browser.evaluate(open), json!(1), "a cell opens its pair");
    browser.evaluate("document.querySelector('.item[open]').open = false");
    click(browser, "document.querySelector('[id^=track] td.map a')");
    assert_eq!(browser.evaluate(open), json!(1), "the same link again");
    // Sorted by the clicked column D, whose values are distinct.
    let first = "document.querySelector('.item[open] tbody tr th').textContent";
    click(
        browser,
        "document.querySelectorAll('.item[open] button.sort')[3]",
    );
    let rising = browser.text(first);
    click(
        browser,
        "document.querySelectorAll('.item[open] button.sort')[3]",
    );
    assert_ne!(browser.text(first), rising, "a table does not sort");
    // A link in the bar opens a folded section.
    click(browser, "document.querySelector('nav a[href=\"#costs\"]')");
    assert_eq!(
        browser.evaluate("document.querySelector('#costs > details').open"),
        json!(true)
    );
    browser.assert_quiet();
}

/// The time line of the gearbox follows dragging by mouse.
pub(crate) fn mice_scrub(browser: &mut Chromium, page: &Path) {
    browser.open(page, DESK);
    browser.evaluate(DRAWN);
    let at = "document.querySelector('.gearboxes .at').textContent";
    let [x, y, wide, _] = place(browser, "document.querySelector('.gearbox-time input')");
    let mut times = Vec::new();
    for share in [-0.4, 0.0, 0.4] {
        let to = x + share * wide;
        let drag = [
            ("mousePressed", x - 0.45 * wide, y),
            ("mouseMoved", x - 0.1 * wide, y),
            ("mouseMoved", to, y),
            ("mouseReleased", to, y),
        ];
        browser.mouse(&drag, 1);
        let label = browser.text(at);
        let seconds = label.split(' ').nth(2).and_then(|s| s.parse::<f64>().ok());
        times.push(seconds.unwrap());
    }
    // A run of 0.02 s, from one end to the other.
    for (seconds, wanted) in times.iter().zip([0.002, 0.01, 0.018]) {
        assert!((seconds - wanted).abs() < 0.001, "{times:?}");
    }
}

/// The switch of themes changes drawings, not only text.
pub(crate) fn the_dark_reaches_the_charts(browser: &mut Chromium, page: &Path) {
    const INK: &str = "(async () => { await new Promise((r) => setTimeout(r, 60)); const c = document.querySelector('#chart canvas'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; \
        let [sum, n] = [0, 0]; for (let k = 0; k < d.length; k += 4) if (d[k + 3] > 250 && Math.abs(d[k] - d[k + 2]) < 30) { sum += d[k]; n += 1; } return sum / n; })()";
    browser.open(page, DESK);
    browser.evaluate(DRAWN);
    let light = browser.evaluate(INK).as_f64().unwrap();
    for _ in 0..2 {
        click(browser, "document.querySelector('#theme')");
    }
    let theme = browser.text("document.documentElement.dataset.theme");
    assert_eq!(theme, "dark");
    let dark = browser.evaluate(INK).as_f64().unwrap();
    assert!(
        (dark - light).abs() > 40.0,
        "axes and grid of {light:.0} in the light and {dark:.0} in the dark"
    );
}

/// On a phone the switch of themes works, fingers read values, the answer comes first.
pub(crate) fn phones_are_served(browser: &mut Chromium, page: &Path) {
    browser.open(page, PHONE);
    browser.evaluate(DRAWN);
    let ground = "getComputedStyle(document.body).backgroundColor";
    let light = browser.text(ground);
    let shown = "(() => { const b = document.querySelector('#theme').getBoundingClientRect(); return b.width > 0 && b.right <= innerWidth && b.left >= 0; })()";
    assert_eq!(browser.evaluate(shown), json!(true), "no switch of themes");
    for _ in 0..2 {
        browser.evaluate("document.querySelector('#theme').click()");
    }
    assert_ne!(browser.text(ground), light, "the switch does nothing");
    let top = "[...document.querySelectorAll('.banner, .tile')].every((e) => e.getBoundingClientRect().bottom + scrollY < 844)";
    assert_eq!(
        browser.evaluate(top),
        json!(true),
        "verdict and figures are not on the first screen"
    );
    let [x, y, ..] = place(browser, OVER);
    browser.evaluate(&format!(
        "{OVER}.dispatchEvent(new PointerEvent('pointerdown', {{ pointerType: 'touch', clientX: {x}, clientY: {y}, bubbles: true }}))"
    ));
    assert!(
        browser.text(TIP).starts_with("t = "),
        "a finger reads nothing"
    );
}

/// In print few sheets have verdict, figures, the gearbox and the chart.
pub(crate) fn paper_is_spared(browser: &mut Chromium, page: &Path) {
    browser.open(page, DESK);
    browser.evaluate(DRAWN);
    let sheets = browser.sheets();
    assert!((1..=4).contains(&sheets), "{sheets} sheets");
    browser.media("print");
    let checks = browser.evaluate(
        "({ parts: ['.banner', '.tiles', '.answer .facts', '.gearbox-view canvas', '#chart canvas', '[id^=track] td.map', '#command'].filter((s) => !document.querySelector(s)?.checkVisibility()), \
            controls: ['.topbar', '#chart-controls', '.gearbox-controls'].filter((s) => document.querySelector(s)?.checkVisibility()), \
            small: [...document.querySelectorAll('main *, footer *')].filter((e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim()) && e.checkVisibility() && !e.closest('.unseen, canvas, script, style') && parseFloat(getComputedStyle(e).fontSize) < 11.99).slice(0, 3).map((e) => e.outerHTML.slice(0, 90)), \
            ground: getComputedStyle(document.body).backgroundColor })",
    );
    browser.media("");
    assert_eq!(checks["parts"], json!([]), "not printed");
    assert_eq!(checks["controls"], json!([]), "printed");
    assert_eq!(checks["small"], json!([]), "below nine points");
    assert_eq!(checks["ground"], json!("rgb(255, 255, 255)"));
}

/// A browser without decompression shows the same values.
pub(crate) fn old_browsers_read_it(browser: &mut Chromium, page: &Path) {
    const VALUES: &str = "(() => { const c = document.querySelector('#chart canvas'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let h = 0; for (const v of d) h = (h * 31 + v) | 0; return h; })()";
    let mut pictures: Vec<Value> = Vec::new();
    for lacking in [false, true] {
        if lacking {
            browser.before_pages("delete window.DecompressionStream");
        }
        browser.open(page, DESK);
        assert_eq!(browser.text(DRAWN), "Ring pin force no. 0");
        assert_eq!(
            browser.evaluate("typeof DecompressionStream"),
            json!(if lacking { "undefined" } else { "function" })
        );
        browser.evaluate("new Promise((r) => setTimeout(r, 60))");
        pictures.push(browser.evaluate(VALUES));
    }
    assert_eq!(
        pictures[0], pictures[1],
        "another picture without DecompressionStream"
    );
}
