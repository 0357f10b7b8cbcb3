// SPDX-License-Identifier: Apache-2.0
// A sketch of Odograph as the source of a camera's pose in Unity. It is compiled against our own declarations (ctest
// -R languages) and has not been run in Unity. README.md has the steps.
using System;
using Odograph;
using UnityEngine;

public sealed class OdographProvider : MonoBehaviour {
  [TextArea] public string Config = "odograph: 1\nwalker: {height: 1.70 m}\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n" +
                                    "vo_frontend: {plugin: vo/odograph}\ncoupling: {type: localizer}\n";
  public string PluginPath = "";
  public long ScreenDelay_ns = 30000000;  // from the newest sample to the light of the screen
  public uint State { get; private set; }

  Session session;
  PicturePool pictures;
  Frame frame;

  void OnEnable() { session = new Session(Config, live: true, pluginPath: PluginPath); }

  void OnDisable() {
    if (session != null) session.Dispose();  // null after an error in the config
    if (pictures != null) pictures.Dispose();
    session = null;
    pictures = null;
  }

  /// Call with the camera's lens before its first picture.
  public void OnLens(ref Calibration calibration) { session.Push(ref calibration); }

  /// Call for each inertial sample, on any thread: rad/s, m/s^2, about +9.81 upwards at rest.
  public void OnImu(long t_ns, Vector gyro, Vector accel) { session.PushImu(t_ns, gyro, accel); }

  /// Call for each grey picture, on one thread: `fill` writes it into the given array, which the library then borrows.
  public void OnPicture(long t_ns, int width, int height, Action<byte[]> fill) {
    if (pictures == null) pictures = new PicturePool(width * height);  // of one size: a larger picture is refused
    Picture picture = pictures.Take();
    fill(picture.Pixels);
    frame = new Frame(t_ns) {format = Abi.ODO_FORMAT_GREY8, width = (uint)width, height = (uint)height};
    session.PushFrame(ref frame, picture);
  }

  void LateUpdate() {
    Pose pose;
    if (!session.TryGetPose(out pose) || !session.TryGetPose(out pose, pose.header.t_ns + ScreenDelay_ns, smooth: true)) return;
    State = pose.state;
    if ((pose.header.flags & Abi.ODO_POSE_POSITION) != 0) transform.localPosition = Place(pose.p_n);
    // Without a camera the orientation is that of the phone's axes, which Turned does not convert.
    if ((pose.header.flags & Abi.ODO_POSE_CAMERA) != 0) transform.localRotation = Turned(pose.q_n);
  }

  /// North-East-Down to Unity's left-handed x right, y up, z ahead: east, up, north.
  public static Vector3 Place(Vector p) { return new Vector3((float)p.y, (float)-p.z, (float)p.x); }

  /// The camera looks along z in both conventions; its y axis points down in Odograph and up in Unity.
  public static Quaternion Turned(Rotation q) {
    Vector ahead = Rotate(q, new Vector(0, 0, 1)), up = Rotate(q, new Vector(0, -1, 0));
    return Quaternion.LookRotation(Place(ahead), Place(up));
  }

  static Vector Rotate(Rotation q, Vector v) {
    double tx = 2 * (q.y * v.z - q.z * v.y), ty = 2 * (q.z * v.x - q.x * v.z), tz = 2 * (q.x * v.y - q.y * v.x);
    return new Vector(v.x + q.w * tx + q.y * tz - q.z * ty, v.y + q.w * ty + q.z * tx - q.x * tz, v.z + q.w * tz + q.x * ty - q.y * tx);
  }
}
