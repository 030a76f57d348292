// Values as short text for links: JSON with the signs that addresses leave alone, after Nix's Rison (2007), less than all of it.
// Objects are (a:1,b:2), lists !(1,2), true !t, false !f, null !n; texts are bare words or stand between quotes.

const WORD = /^[A-Za-z_][\w.-]*/;
const NUMBER = /^-?\d+(\.\d+)?(e[+-]?\d+)?/i;
const DEEPEST = 8;

export function encode(value) {
  if (value === null || value === undefined) return '!n';
  if (value === true) return '!t';
  if (value === false) return '!f';
  if (typeof value === 'number') return Number.isFinite(value) ? String(value) : '!n';
  if (typeof value === 'string') return WORD.exec(value)?.[0] === value ? value : `'${value.replace(/['!]/g, '!$&')}'`;
  if (Array.isArray(value)) return `!(${value.map(encode).join(',')})`;
  return `(${Object.entries(value).map(([key, inner]) => `${encode(key)}:${encode(inner)}`).join(',')})`;
}

/** The value; undefined where the text is none. */
export function decode(text) {
  const reader = { text, at: 0 };
  const value = readValue(reader, 0);
  return reader.at === text.length ? value : undefined;
}

function readValue(reader, depth) {
  const rest = reader.text.slice(reader.at);
  if (depth > DEEPEST) return undefined;
  const constants = { '!t': true, '!f': false, '!n': null };
  const sign = rest.slice(0, 2);
  if (sign in constants) {
    reader.at += 2;
    return constants[sign];
  }
  if (sign === '!(') {
    reader.at += 2;
    return readList(reader, depth);
  }
  if (rest[0] === '(') {
    reader.at += 1;
    return readObject(reader, depth);
  }
  if (rest[0] === "'") return readQuoted(reader);
  const number = NUMBER.exec(rest)?.[0];
  const word = number ?? WORD.exec(rest)?.[0];
  if (word === undefined) return undefined;
  reader.at += word.length;
  return number === undefined ? word : Number(number);
}

/** Takes a sign if it is next. */
function take(reader, sign) {
  if (reader.text[reader.at] !== sign) return false;
  reader.at += 1;
  return true;
}

function readList(reader, depth) {
  const list = [];
  if (take(reader, ')')) return list;
  for (;;) {
    const value = readValue(reader, depth + 1);
    if (value === undefined) return undefined;
    list.push(value);
    if (take(reader, ')')) return list;
    if (!take(reader, ',')) return undefined;
  }
}

function readObject(reader, depth) {
  const entries = [];
  if (take(reader, ')')) return {};
  for (;;) {
    const key = readValue(reader, depth + 1);
    if (typeof key !== 'string' || !take(reader, ':')) return undefined;
    const value = readValue(reader, depth + 1);
    if (value === undefined) return undefined;
    entries.push([key, value]);
    if (take(reader, ')')) return Object.fromEntries(entries);
    if (!take(reader, ',')) return undefined;
  }
}

function readQuoted(reader) {
  const found = /^'((?:[^'!]|!['!])*)'/.exec(reader.text.slice(reader.at));
  if (!found) return undefined;
  reader.at += found[0].length;
  return found[1].replace(/!(['!])/g, '$1');
}
