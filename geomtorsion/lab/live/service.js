// Keeps the files of the page, so that it opens without a network. What never changes under its
// name comes from what is kept; the rest is asked for first, and kept for when nobody answers.
const KEPT = "geomtorsion-lab-@DIGEST@";
const FIXED = /\/(pyodide|wheels-[0-9a-f]+)\/[^/]+$/;

// What the page had loaded before anybody kept files.
const BEFORE = ["./", "index.html", "live.js"];

self.addEventListener("install", (event) => event.waitUntil((async () => {
  const kept = await caches.open(KEPT);
  // Some hosts have no page under the address of a folder.
  await Promise.allSettled(BEFORE.map((file) => kept.add(file)));
  await self.skipWaiting();
})()));
self.addEventListener("activate", (event) => event.waitUntil((async () => {
  for (const name of await caches.keys()) {
    if (name.startsWith("geomtorsion-lab-") && name !== KEPT) await caches.delete(name);
  }
  await self.clients.claim();
})()));

async function asked(request, kept) {
  const response = await fetch(request);
  // The address says what is typed; the file is the same for all.
  const { origin, pathname } = new URL(request.url);
  // What there is no room for is given all the same.
  if (response.ok) await kept.put(origin + pathname, response.clone()).catch(() => {});
  return response;
}

async function answered(request) {
  const kept = await caches.open(KEPT);
  const found = await kept.match(request, { ignoreSearch: true });
  if (found && FIXED.test(new URL(request.url).pathname)) return found;
  try {
    return await asked(request, kept);
  } catch (error) {
    if (found) return found;
    throw error;
  }
}

self.addEventListener("fetch", (event) => {
  const { request } = event;
  const here = request.url.startsWith(self.registration.scope);
  if (request.method === "GET" && here) event.respondWith(answered(request));
});
