// SPDX-License-Identifier: Apache-2.0
// Usage: node write_ros2.mjs TABLE.csv BAG.mcap
// Writes a table 't,a_y,f' as ROS 2 records it: sensor_msgs/Imu and geometry_msgs/WrenchStamped with
// their definitions (ros2msg), by the MCAP project's own writer.  The CDR bytes are laid out here, by
// OMG DDS-XTypes 1.3, 7.4.3: little endian, each value aligned to its size.
import { closeSync, openSync, readFileSync, writeSync } from "node:fs";
import { McapWriter } from "@mcap/core";

const [table, bag] = process.argv.slice(2);
const EPOCH_S = 1700000000;
const RULE = "=".repeat(80);
const HEADER = `${RULE}\nMSG: std_msgs/Header\n# Standard metadata\nbuiltin_interfaces/Time stamp\nstring frame_id\n` +
  `${RULE}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n`;
const VECTOR = `${RULE}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n`;
const IMU = "std_msgs/Header header\n\ngeometry_msgs/Quaternion orientation\n" +
  "float64[9] orientation_covariance # Row major about x, y, z axes\n" +
  "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n" +
  "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n" +
  `${RULE}\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n${VECTOR}${HEADER}`;
const WRENCH = `std_msgs/Header header\nWrench wrench\n${RULE}\nMSG: geometry_msgs/Wrench\n` +
  `geometry_msgs/Vector3  force\ngeometry_msgs/Vector3  torque\n${VECTOR}${HEADER}`;

class Cdr {
  constructor() {
    this.bytes = [0, 1, 0, 0]; // encapsulation: CDR, little endian
  }
  number(size, set) {
    while ((this.bytes.length - 4) % size !== 0) this.bytes.push(0);
    const view = new DataView(new ArrayBuffer(size));
    set(view);
    this.bytes.push(...new Uint8Array(view.buffer));
  }
  int32(value) { this.number(4, (view) => view.setInt32(0, value, true)); }
  uint32(value) { this.number(4, (view) => view.setUint32(0, value, true)); }
  doubles(...values) {
    for (const value of values) this.number(8, (view) => view.setFloat64(0, value, true));
  }
  header(time_ns) {
    this.int32(EPOCH_S + Math.floor(time_ns / 1e9));
    this.uint32(time_ns % 1e9);
    const frame = Buffer.from("base_link\0");
    this.uint32(frame.length);
    this.bytes.push(...frame);
  }
}

const rows = readFileSync(table, "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
const descriptor = openSync(bag, "w");
let size = 0n;
const writable = {
  async write(part) { writeSync(descriptor, part); size += BigInt(part.byteLength); },
  position: () => size,
};
const writer = new McapWriter({ writable });
await writer.start({ profile: "ros2", library: "peer" });
const channels = [];
for (const [topic, name, text] of [["/imu/data", "sensor_msgs/msg/Imu", IMU],
                                   ["/stick/wrench", "geometry_msgs/msg/WrenchStamped", WRENCH]]) {
  const schemaId = await writer.registerSchema({ name, encoding: "ros2msg", data: Buffer.from(text) });
  channels.push(await writer.registerChannel({ topic, schemaId, messageEncoding: "cdr", metadata: new Map() }));
}
const nine = Array(9).fill(0);
for (const [sequence, [t, a_y, f]] of rows.entries()) {
  const time_ns = Math.round(t * 1e9);
  const imu = new Cdr();
  imu.header(time_ns);
  imu.doubles(0, 0, 0, 1, ...nine, 0, 0, 0.1, ...nine, 0.5, a_y, 9.81, ...nine);
  const wrench = new Cdr();
  wrench.header(time_ns);
  wrench.doubles(1, f, 2, 0, 0, 0);
  const logTime = BigInt(EPOCH_S) * 1000000000n + BigInt(time_ns) + 2000000n;
  for (const [i, message] of [imu, wrench].entries()) {
    const data = Uint8Array.from(message.bytes);
    await writer.addMessage({ channelId: channels[i], sequence, logTime, publishTime: logTime, data });
  }
}
await writer.end();
closeSync(descriptor);
