// node suite.mjs PYODIDE CHECKOUT SITE FILE...: files of tests, on the Python that browsers get.
import { pathToFileURL } from "node:url";

const [core, checkout, site, ...files] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(`${core}/pyodide.mjs`));
const python = await loadPyodide({ env: { HOME: "/tmp", PYTHONDONTWRITEBYTECODE: "1" } });
for (const [place, root] of [["/checkout", checkout], ["/site", site]]) {
  python.FS.mkdirTree(place);
  python.FS.mount(python.FS.filesystems.NODEFS, { root }, place);
}
python.globals.set("files", python.toPy(files));
process.exit(python.runPython(`
import os, sys
os.chdir("/checkout")
sys.path[:0] = ["/checkout", "/site"]
from tests.lab.live.without_numpy import run
run(list(files))
`));
