// Measures the page of a running server in Chromium: violations found by axe, Lighthouse's scores, errors in the console; saves a screenshot of each state.
// client-wasm/README.md has the command. Arguments: address of the server, folder for the screenshots.

const { mkdirSync } = require("node:fs");
const { join } = require("node:path");
const puppeteer = require("puppeteer-core");
const axe = require("axe-core");

const [address = "http://127.0.0.1:8080", folder = "/tmp/page-checks"] = process.argv.slice(2);
const executablePath = process.env.CHROME_PATH;

const BASE = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--force-device-scale-factor=1"];
const WEBGPU = ["--enable-unsafe-webgpu", "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=swiftshader"];
const SIZES = [[390, 844], [960, 540], [1920, 1080]];
const QUERY = "?paused=1&quality=low&name=Ada";

// Keeps the sockets of the page, so that `window.disconnect()` can make the server unreachable.
const DISCONNECT = () => {
  const sockets = [];
  let gone = false;
  window.WebSocket = class extends WebSocket {
    constructor(...rest) {
      super(...rest);
      sockets.push(this);
      if (gone) this.close();
    }
  };
  window.disconnect = () => {
    gone = true;
    for (const socket of sockets) socket.close();
  };
};

let violations = 0;

async function check(page, state) {
  await new Promise((done) => setTimeout(done, 300));
  await page.screenshot({ path: join(folder, `${state}.png`) });
  await page.evaluate(axe.source);
  const found = await page.evaluate(() => axe.run());
  violations += found.violations.length;
  console.log(`axe, ${state}: ${found.passes.length} rules pass, ${found.violations.length} are violated`);
  for (const { id, impact, help, nodes } of found.violations) console.log(`  ${impact}: ${id}: ${help}: ${nodes.map(({ target }) => target.join(" ")).join(", ")}`);
}

async function open(browser, [width, height], query, script = DISCONNECT) {
  const page = await browser.newPage();
  page.setDefaultTimeout(180_000);
  await page.setViewport({ width, height, hasTouch: width < 640, isMobile: width < 640 });
  page.on("console", (line) => ["error", "warn"].includes(line.type()) && console.log(`  console: ${line.text()}`));
  page.on("pageerror", (error) => console.log(`  error: ${error.message}`));
  await page.evaluateOnNewDocument(script);
  await page.goto(address + query);
  return page;
}

const kind = (page, expected) => page.waitForFunction((expected) => document.getElementById("message").dataset.kind === expected, {}, expected);

async function drawn(browser, size, query = QUERY) {
  const page = await open(browser, size, query);
  await page.waitForFunction(() => window.prairie?.state()?.time_secs > 0 && document.getElementById("message").hidden);
  for (const time of [0.1, 0.2, 0.3]) await page.evaluate((time) => window.prairie.draw(time), time);
  return page;
}

async function withWebgpu() {
  const browser = await puppeteer.launch({ executablePath, args: [...BASE, ...WEBGPU] });
  for (const size of SIZES) {
    const name = size.join("x");
    const page = await drawn(browser, size);
    await check(page, `page-${name}`);
    await page.evaluate(() => { document.getElementById("panel").hidden = !(document.getElementById("open").hidden = !document.getElementById("open").hidden) });
    await check(page, `other-panel-${name}`);
    await page.evaluate(() => document.getElementById("help").showModal());
    await check(page, `help-${name}`);
    await page.evaluate(() => document.getElementById("help").close());
    await page.evaluate(() => window.disconnect());
    await kind(page, "server-gone");
    await check(page, `server-gone-${name}`);
    await page.evaluate(() => window.prairie.panic("a panic to try this message"));
    await kind(page, "panicked");
    await check(page, `panicked-${name}`);
    await page.close();
  }
  await browser.close();
}

async function withoutWebgpu() {
  const browser = await puppeteer.launch({ executablePath, args: BASE });
  for (const [expected, script] of [["no-adapter", () => {}], ["unsupported", () => Object.defineProperty(Navigator.prototype, "gpu", { value: undefined })]]) {
    for (const size of SIZES) {
      const page = await open(browser, size, "", script);
      await kind(page, expected);
      await check(page, `${expected}-${size.join("x")}`);
      await page.close();
    }
  }
  await browser.close();
}

async function lighthouse() {
  const { default: run } = await import(require.resolve("lighthouse"));
  const browser = await puppeteer.launch({ executablePath, args: [...BASE, ...WEBGPU] });
  const categories = ["accessibility", "best-practices", "seo"];
  for (const formFactor of ["mobile", "desktop"]) {
    const page = await browser.newPage();
    const screen = formFactor === "mobile" ? {} : { screenEmulation: { mobile: false, width: 1350, height: 940, deviceScaleFactor: 1, disabled: false } };
    const flags = { onlyCategories: categories, formFactor, ...screen, throttlingMethod: "provided", maxWaitForLoad: 60_000 };
    const { lhr } = await run(`${address}/${QUERY}`, flags, undefined, page);
    const scores = Object.values(lhr.categories).map(({ id, score }) => `${id} ${Math.round(score * 100)}`);
    console.log(`Lighthouse, ${formFactor}: ${scores.join(", ")}`);
    for (const { id, score, title } of Object.values(lhr.audits)) if (score !== null && score < 0.9 && score >= 0) console.log(`  ${id}: ${title}`);
    await page.close();
  }
  await browser.close();
}

mkdirSync(folder, { recursive: true });
withWebgpu().then(withoutWebgpu).then(lighthouse).then(() => process.exit(violations ? 1 : 0), (error) => {
  console.error(error);
  process.exit(2);
});
