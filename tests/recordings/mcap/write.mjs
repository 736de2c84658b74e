// Writes the MCAP files of this folder by another implementation of the format:
//   npm install @mcap/core@2.2.2 @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0
//       @foxglove/wasm-zstd@1.0.1 lz4js@0.2.0; node write.mjs
import { McapWriter } from '@mcap/core';
import rosmsg from '@foxglove/rosmsg';
import { MessageWriter } from '@foxglove/rosmsg2-serialization';
import zstd from '@foxglove/wasm-zstd';
import lz4 from 'lz4js';
import fs from 'node:fs';

await zstd.isLoaded;
const line = '='.repeat(80);
const jointState = `# The state of joints.
std_msgs/Header header

string[] name
float64[] position
float64[] velocity
float64[] effort
${line}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
${line}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
`;
const command = `int32 KIND=3  # a constant
std_msgs/MultiArrayLayout layout
float64[] data
uint8 mode 2
float32[3] gains
bool is_on
string<=9 note "none # of it"
${line}
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
${line}
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
`;
const second = 1700000000;
const ns = (k, late = 0) => BigInt(second) * 1000000000n + BigInt(k) * 10000000n + BigInt(late);
const encode = (text, message) => new MessageWriter(rosmsg.parse(text, { ros2: true })).writeMessage(message);

async function write(file, options) {
  const chunks = [];
  let size = 0n;
  const writable = {
    write: async bytes => { chunks.push(Buffer.from(bytes)); size += BigInt(bytes.length); },
    position: () => size,
  };
  const writer = new McapWriter({ writable, chunkSize: 4000, ...options });
  await writer.start({ profile: 'ros2', library: '' });
  const channel = async (topic, name, encoding, data, messageEncoding) =>
    writer.registerChannel({
      topic, messageEncoding, metadata: new Map(),
      schemaId: name === '' ? 0 : await writer.registerSchema({ name, encoding, data: Buffer.from(data) }),
    });
  const joints = await channel('/joint_states', 'sensor_msgs/msg/JointState', 'ros2msg', jointState, 'cdr');
  const commands = await channel('/commands', 'my_msgs/msg/Command', 'ros2msg', command, 'cdr');
  const json = await channel('/fingers', '', '', '', 'json');
  const image = await channel('/camera', 'foxglove.CompressedImage', 'protobuf', 'x', 'protobuf');
  const add = (channelId, k, late, data) =>
    writer.addMessage({ channelId, sequence: k, logTime: ns(k, late), publishTime: ns(k), data });
  for (let k = 0; k < 60; ++k) {
    // Every third message has the joints in another order, and the eighth lacks one.
    const all = [['index_mcp', 0.01 * k], ['middle/mcp', 0.5], ['ring_mcp', 1 - 0.01 * k]];
    if (k % 3 === 2) all.reverse();
    const some = k === 7 ? all.slice(0, 2) : all;
    const stamp = { sec: second + Math.floor(k / 100), nanosec: (k % 100) * 10000000 };
    await add(joints, k, 3000000 + 1000 * (k % 5), encode(jointState, {
      header: { stamp, frame_id: 'hand' + 'x'.repeat(k % 4) }, name: some.map(j => j[0]),
      position: some.map(j => j[1]), velocity: k % 2 ? some.map(() => -k) : [], effort: [] }));
    await add(commands, k, 4000000, encode(command, {
      layout: { dim: [{ label: 'joints', size: 2, stride: 2 }], data_offset: 0 },
      data: [k, -k / 2], mode: k % 200, gains: [0.5, k, -1], is_on: k % 2 === 0, note: 'n'.repeat(k % 9) }));
    await add(json, k, 5000000, Buffer.from(JSON.stringify({
      name: ['thumb', 'index'], position: [k, k / 4], seq: k, is_good: k !== 4, note: 'n',
      palm: { x: k === 5 ? null : 2 * k, q: [0, 1] } })));
    if (k % 10 === 0) await add(image, k, 0, Buffer.alloc(300, k));
  }
  await writer.end();
  fs.writeFileSync(file, Buffer.concat(chunks));
}

const byZstd = data => ({ compression: 'zstd', compressedData: new Uint8Array(zstd.compress(data, 3)) });
const byLz4 = data => ({ compression: 'lz4', compressedData: new Uint8Array(lz4.compress(data)) });
const without = { useStatistics: false, useSummaryOffsets: false, repeatSchemas: false, repeatChannels: false,
  useMessageIndex: false, useChunkIndex: false };
await write('zstd.mcap', { compressChunk: byZstd });
await write('lz4.mcap', { compressChunk: byLz4 });
await write('plain.mcap', { useChunks: false });
await write('no_index.mcap', { ...without, compressChunk: byLz4 });
