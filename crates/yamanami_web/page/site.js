// The list of surfaces beside the page: site.json.

/** Surfaces of a list that make sense; throws when it is no such list. */
export async function readSite(url) {
  const response = await fetch(url, { cache: 'no-cache' });
  if (!response.ok) throw new Error(`${response.status} ${response.statusText}`.trim());
  const list = (await response.json())?.surfaces;
  if (!Array.isArray(list)) throw new Error('expected {"surfaces": [...]}');
  return list.map((entry) => surfaceOf(entry, url)).filter((surface) => surface !== null);
}

function surfaceOf(entry, url) {
  const isText = (value) => typeof value === 'string' && value !== '';
  if (!isText(entry?.name) || !isText(entry.pack)) return null;
  const resolve = (address) => (isText(address) ? new URL(address, url).href : null);
  return {
    name: entry.name,
    title: isText(entry.title) ? entry.title : entry.name,
    pack: resolve(entry.pack),
    picture: resolve(entry.picture),
    credit: isText(entry.credit) ? entry.credit : '',
  };
}
