// Opens a recording in Foxglove Studio, imports the layout and plays it, as a person does, and prints what there is
// to see: node look.mjs BROWSER RECORDING LAYOUT PICTURES, the two files by their names beside this one.
import { join } from "node:path";
import { chromium } from "playwright-core";
import { serve } from "./serve.mjs";

const [, , executablePath, recording, layout, pictures] = process.argv;
const DRAWN_WITHOUT_A_GRAPHICS_CARD = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const ALONE = ["--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"];
const SIZE = { width: 1600, height: 900 };
const END_OF_THE_TIMELINE = { x: 1591, y: 844 };
const PATIENCE_MS = 240_000;

async function pixels([picture, box]) {
  // Runs in the page: how many pixels of a part of a picture are of each colour of the layout.
  const image = await createImageBitmap(await (await fetch(picture)).blob(), box.x, box.y, box.width, box.height);
  const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, image.width, image.height);
  const found = { yellow: 0, blue: 0, red: 0 };
  for (let i = 0; i < data.length; i += 4) {
    const [red, green, blue] = data.subarray(i, i + 3);
    found.yellow += red > 100 && green > 0.7 * red && blue < 0.6 * red;
    found.blue += blue > 100 && green > 0.5 * blue && red < 0.6 * blue;
    found.red += red > 90 && green < 0.6 * red && blue < 0.6 * red;
  }
  return found;
}

const site = await serve(import.meta.dirname);
const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", ...DRAWN_WITHOUT_A_GRAPHICS_CARD, ...ALONE],
});
const page = await browser.newPage({ viewport: SIZE });
page.setDefaultTimeout(PATIENCE_MS);
const found = { errors: [], panels: {} };
page.on("pageerror", (error) => found.errors.push(String(error)));
await page.route((url) => url.hostname !== "127.0.0.1", (route) => route.abort());
await page.addInitScript((address) => {
  window.showOpenFilePicker = async () => [
    { getFile: async () => new File([await (await fetch(address)).blob()], "layout.json") },
  ];
}, `${site.url}/${layout}`);

const panel = (id) => page.locator(`[data-testid="panel-mouseenter-container ${id}"]`);
const showTab = (title) => page.getByTestId("toolbar-tab").and(page.getByTitle(title, { exact: true })).click();

async function look(name, ids) {
  // A picture of all, and what colours are in some panels, once something of each is there.
  for (let tries = 0; tries < 20; tries++) {
    await page.waitForTimeout(3000);
    const picture = await page.screenshot({ path: join(pictures, `${name}.png`), timeout: PATIENCE_MS });
    for (const id of ids) {
      const address = `data:image/png;base64,${picture.toString("base64")}`;
      found.panels[id] = await page.evaluate(pixels, [address, await panel(id).boundingBox()]);
    }
    if (ids.every((id) => found.panels[id].yellow > 20)) {
      break;
    }
  }
}

async function tour() {
  const source = new URLSearchParams({ ds: "remote-file", "ds.url": `${site.url}/${recording}` });
  await page.goto(`${site.url}/index.html?${source}`, { timeout: PATIENCE_MS });
  await page.getByText("/weather/truth/grid").first().waitFor({ state: "attached" });
  await page.locator("[aria-label*=Layouts], [title*=Layouts]").first().click();
  await page.getByTitle("Import layout").click();
  await panel("Plot!errors").waitFor();
  await page.locator("[aria-label*='ata source'], [title*='ata source']").first().click();
  await page.getByTitle("Play", { exact: true }).click();
  await panel("RosOut!events").getByText("departure").first().waitFor();
  await page.mouse.click(END_OF_THE_TIMELINE.x, END_OF_THE_TIMELINE.y);
  await page.getByTitle("Play", { exact: true }).waitFor(); // where it stops
  await look("above", ["3D!area", "Plot!height", "Plot!speed", "Plot!errors"]);
  const lines = panel("map!position").locator("path");
  found.lines = await lines.evaluateAll((paths) => paths.map((path) => path.getAttribute("stroke")));
  found.goals = await panel("map!position").locator(".leaflet-marker-icon").count();
  await showTab("From behind");
  await showTab("Outcome");
  await panel("RawMessages!outcome").getByText("detail").first().waitFor();
  await look("behind", ["3D!behind"]);
  await page.getByText("Problems", { exact: true }).click();
  found.fine = await page.getByText("No problems found").isVisible();
}

try {
  await tour();
  console.log(JSON.stringify(found));
} catch (error) {
  await page.screenshot({ path: join(pictures, "stuck.png"), timeout: PATIENCE_MS });
  throw error;
} finally {
  await browser.close();
  site.close();
}
