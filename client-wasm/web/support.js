// Browsers with WebGPU, by platform. Sources: MDN's browser-compat-data 8.1.9 and the implementation status of the WebGPU working group (gpuweb).

// When the table was last compared with its sources.
export const CHECKED = "November 2026";

// Platform, how its browsers describe it, and its browsers with WebGPU.
const PLATFORMS = [
  ["Android 12 or newer", /Android/, "Chrome or Edge 121 or newer, Samsung Internet 25 or newer. Firefox does not have it yet."],
  ["iPhone, iPad", /iPhone|iPad/, "any browser on iOS or iPadOS 26 or newer."],
  ["ChromeOS", /CrOS/, "Chrome 113 or newer."],
  ["Windows", /Windows/, "Chrome or Edge 113 or newer, Firefox 141 or newer."],
  ["macOS", /Mac/, "Chrome or Edge 113 or newer, Safari 26 or newer on macOS 26, Firefox 147 or newer with Apple silicon."],
  ["Linux", /Linux/, "Chrome or Edge 144 or newer with Intel graphics since 2020 (generation 12), 147 with NVIDIA's driver 535.183 or newer. For other graphics, start " +
    "Chrome or Chromium with `--enable-unsafe-webgpu` `--enable-features=Vulkan`, or use Firefox Nightly."],
];

// Platforms with their browsers, this platform first.
export function support(agent = navigator.userAgent, touches = navigator.maxTouchPoints) {
  // iPads describe themselves as Macs, which have no touch screen.
  const described = /Mac/.test(agent) && touches > 1 ? "iPad" : agent;
  const own = PLATFORMS.find(([, pattern]) => pattern.test(described));
  const others = PLATFORMS.filter((platform) => platform !== own);
  return [...(own ? [[`${own[0]}, as here`, own[2]]] : []), ...others.map(([name, , browsers]) => [name, browsers])];
}

export const isLinux = () => PLATFORMS.find(([, pattern]) => pattern.test(navigator.userAgent))?.[0] === "Linux";
