// Serves this folder on the machine itself, parts of files too, as Foxglove reads recordings from afar.
import { createServer } from "node:http";
import { createReadStream, statSync } from "node:fs";
import { extname, join, normalize } from "node:path";

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json", ".wasm": "application/wasm" };

function answer(folder, request, response) {
  const path = join(folder, normalize(decodeURIComponent(new URL(request.url, "http://host").pathname)));
  const size = statSync(path, { throwIfNoEntry: false })?.size;
  if (size === undefined) {
    return response.writeHead(404).end();
  }
  const headers = { "accept-ranges": "bytes", "content-type": TYPES[extname(path)] ?? "application/octet-stream" };
  const range = /bytes=(\d+)-(\d*)/.exec(request.headers.range ?? "");
  const start = Number(range?.[1] ?? 0);
  const end = range?.[2] ? Math.min(Number(range[2]), size - 1) : size - 1;
  if (range) {
    headers["content-range"] = `bytes ${start}-${end}/${size}`;
  }
  response.writeHead(range ? 206 : 200, { ...headers, "content-length": end - start + 1 });
  createReadStream(path, { start, end }).pipe(response);
}

export async function serve(folder) {
  const server = createServer((request, response) => answer(folder, request, response));
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  return { url: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}
