// Writes the keypoints of hand.csv into Parquet and MCAP by other implementations of these formats:
//   npm install hyparquet-writer@0.17.0 @mcap/core@2.2.2 @foxglove/rosmsg@5.0.4
//       @foxglove/rosmsg2-serialization@3.1.0; node write.mjs
// hand.csv has every second frame of those that tests/recordings/keypoints_test.cc writes.
import { parquetWriteBuffer } from 'hyparquet-writer';
import { McapWriter } from '@mcap/core';
import rosmsg from '@foxglove/rosmsg';
import { MessageWriter } from '@foxglove/rosmsg2-serialization';
import fs from 'node:fs';

const [, ...rows] = fs.readFileSync('hand.csv', 'utf8').trim().split('\n').map(line => line.split(',').map(Number));
const parquet = parquetWriteBuffer({
  schema: [{ name: 'root', num_children: 2 },
    { name: 'time_s', repetition_type: 'OPTIONAL', type: 'DOUBLE' },
    { name: 'landmarks', repetition_type: 'OPTIONAL', num_children: 1, converted_type: 'LIST' },
    { name: 'list', repetition_type: 'REPEATED', num_children: 1 },
    { name: 'element', repetition_type: 'OPTIONAL', type: 'DOUBLE' }],
  columnData: [{ name: 'time_s', data: rows.map(row => row[0]) }, { name: 'landmarks', data: rows.map(row => row.slice(1)) }],
});
fs.writeFileSync('hand.parquet', Buffer.from(parquet));

const line = '='.repeat(80);
const poseArray = `std_msgs/Header header
geometry_msgs/Pose[] poses
${line}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
${line}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
${line}
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
${line}
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
${line}
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
`;
const chunks = [];
let size = 0n;
const writable = {
  write: async bytes => { chunks.push(Buffer.from(bytes)); size += BigInt(bytes.length); },
  position: () => size,
};
const writer = new McapWriter({ writable });
await writer.start({ profile: 'ros2', library: '' });
const schemaId = await writer.registerSchema({
  name: 'geometry_msgs/msg/PoseArray', encoding: 'ros2msg', data: new TextEncoder().encode(poseArray),
});
const channelId = await writer.registerChannel({ topic: '/hand', schemaId, messageEncoding: 'cdr', metadata: new Map() });
const messages = new MessageWriter(rosmsg.parse(poseArray, { ros2: true }));
for (const [sequence, row] of rows.entries()) {
  const stamp = { sec: 1700000000, nanosec: Math.round(1e9 * row[0]) };
  const poses = [...Array(21).keys()].map(i => ({
    position: { x: row[1 + 3 * i], y: row[2 + 3 * i], z: row[3 + 3 * i] },
    orientation: { x: 0, y: 0, z: 0, w: 1 },
  }));
  const logTime = 1700000000000000000n + BigInt(stamp.nanosec);
  await writer.addMessage({
    channelId, sequence, logTime, publishTime: logTime,
    data: messages.writeMessage({ header: { stamp, frame_id: 'hand' }, poses }),
  });
}
await writer.end();
fs.writeFileSync('hand.mcap', Buffer.concat(chunks));
