// Writes the Parquet files of this folder by another implementation of the format:
//   npm install hyparquet-writer@0.17.0; node write.mjs
import { parquetWriteBuffer } from 'hyparquet-writer';
import fs from 'node:fs';
import { gzipSync } from 'node:zlib';

const rows = [...Array(60).keys()];
const columnData = [
  { name: 'action', data: rows.map(k => [k, k / 2, k === 7 ? null : -k]) },
  { name: 'timestamp', data: rows.map(k => Math.fround((k % 30) / 30)) },
  { name: 'frame_index', data: rows.map(k => BigInt(k % 30)) },
  { name: 'episode_index', data: rows.map(k => BigInt(k < 30 ? 0 : 1)) },
  { name: 'is_done', data: rows.map(k => k % 30 === 29) },
  { name: 'task', data: rows.map(k => 'open the door ' + k) },
  { name: 'force', data: rows.map(k => (k === 3 ? null : 0.1 * k)) },
];
const list = name => [{ name, repetition_type: 'OPTIONAL', num_children: 1, converted_type: 'LIST' },
  { name: 'list', repetition_type: 'REPEATED', num_children: 1 },
  { name: 'element', repetition_type: 'OPTIONAL', type: 'FLOAT' }];
const one = (name, type, more = {}) => [{ name, repetition_type: 'OPTIONAL', type, ...more }];
const schema = [{ name: 'root', num_children: 7 }, ...list('action'), ...one('timestamp', 'FLOAT'),
  ...one('frame_index', 'INT64'), ...one('episode_index', 'INT64'), ...one('is_done', 'BOOLEAN'),
  ...one('task', 'BYTE_ARRAY', { converted_type: 'UTF8' }), ...one('force', 'DOUBLE')];
for (const codec of ['UNCOMPRESSED', 'SNAPPY', 'GZIP']) {
  const file = parquetWriteBuffer({ columnData, schema, codec, rowGroupSize: 25, compressors: { GZIP: gzipSync } });
  fs.writeFileSync(codec.toLowerCase() + '.parquet', Buffer.from(file));
}
