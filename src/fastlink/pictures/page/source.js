// Where values come from: the server of this machine, or this page itself.
"use strict";
async function asked(what, query) {
  const address = `${what}?query=${encodeURIComponent(JSON.stringify(query))}`;
  const reply = await fetch(address, {headers: {"X-Token": content.token}});
  if (!reply.ok) throw new Error(`${reply.status}: ${await reply.text()}`);
  return reply;
}
async function framed(reply) {
  const bytes = await reply.arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  return {...head, values: new Float32Array(bytes, 4 + length)};
}
const numbered = row => Object.fromEntries(Object.entries(row).map(([name, value]) =>
  [name, ["NaN", "Infinity", "-Infinity"].includes(value) ? Number(value) : value]));
const served = {
  picture: async query => framed(await asked("picture", query)),
  column: async query => framed(await asked("column", query)),
  row: async query => numbered(await (await asked("row", query)).json()),
  region: async query => {
    const found = await (await asked("region", query)).json();
    for (const name in found.values) found.values[name] = found.values[name].map(one => one === null ? NaN : one);
    return {...found, best: found.best.map(one => ({...one, row: numbered(one.row)}))};
  },
};
