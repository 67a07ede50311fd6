// The worker in which Python runs. The page ends it when a request takes too long.
import { loadPyodide } from "./pyodide/pyodide.mjs";

const native = self.fetch.bind(self);
let done = 0;

// Everything that is fetched moves the bar; `share` is what is fetched of the whole start.
function counted(total, share) {
  self.fetch = async (...given) => {
    const response = await native(...given);
    if (!response.ok || !response.body) return response;
    const counter = new TransformStream({
      transform(chunk, to) {
        done += chunk.byteLength;
        tell(Math.min(done / total, 1) * share, "loading files");
        to.enqueue(chunk);
      },
    });
    return new Response(response.body.pipeThrough(counter), response);
  };
}

const tell = (share, words) => postMessage({ kind: "progress", share, words });

async function start(config) {
  counted(config.bytes, 0.5);
  const folder = new URL("./", self.location).href;
  // All files at once: the slowest of them is what is waited for.
  const archives = config.archives.map(async ({ file, format, into }) => {
    const response = await fetch(folder + file);
    if (!response.ok) throw new Error(`${file}: the host answered ${response.status}`);
    return { bytes: new Uint8Array(await response.arrayBuffer()), format, into };
  });
  const python = await loadPyodide({ indexURL: `${folder}pyodide/` });
  let count = 0;
  for (const archive of archives) {
    const { bytes, format, into } = await archive;
    python.unpackArchive(bytes, format, into ? { extractDir: into } : {});
    tell(0.5 + (0.1 * ++count) / archives.length, "unpacking");
  }
  for (const [k, [words, code]] of config.imports.entries()) {
    tell(0.6 + (0.4 * k) / config.imports.length, words);
    python.runPython(code);
  }
  return python.globals.get("answer");
}

let answer = null;
onmessage = async ({ data }) => {
  try {
    if (data.kind === "start") {
      answer = await start(data.config);
      postMessage({ kind: "ready" });
    } else {
      postMessage({ kind: "reply", reply: answer(data.request) });
    }
  } catch (error) {
    postMessage({ kind: "failed", why: String(error).slice(-2000) });
  }
};
