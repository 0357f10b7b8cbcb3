// SPDX-License-Identifier: Apache-2.0
// The part of UnityEngine that samples/unity uses, and tests of its conversions and of a tap on a simulated walk.
//   Unity.exe RECORDING.odo, whose frames are PGM
using System;
using System.Collections.Generic;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Text;

namespace UnityEngine {
  public class TextAreaAttribute : Attribute {}
  public struct Vector2 {
    public float x, y;
  }
  public struct Vector3 {
    public float x, y, z;
    public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
    public static implicit operator Vector3(Vector2 v) { return new Vector3(v.x, v.y, 0); }
    public static Vector3 operator +(Vector3 a, Vector3 b) { return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z); }
    public static Vector3 operator *(float f, Vector3 v) { return new Vector3(f * v.x, f * v.y, f * v.z); }
  }
  public struct Quaternion {
    public Vector3 Ahead, Up;
    public static Quaternion LookRotation(Vector3 ahead, Vector3 up) { return new Quaternion {Ahead = ahead, Up = up}; }
  }
  public struct Pose {
    public Vector3 position;
    public Quaternion rotation;
    public Pose(Vector3 position, Quaternion rotation) { this.position = position; this.rotation = rotation; }
  }
  public struct Ray {
    public Vector3 origin { get; set; }
    public Vector3 direction { get; set; }
  }
  public class Event {}
  public class Camera {
    public static Vector3 Direction;
    public Ray ScreenPointToRay(Vector3 point) { return new Ray {direction = Direction}; }
  }
  public class Transform {
    public Vector3 localPosition;
    public Quaternion localRotation;
  }
  public class MonoBehaviour {
    public Transform transform = new Transform();
    public T GetComponent<T>() where T : new() { return new T(); }
  }
}

static class UnityTests {
  static bool Near(UnityEngine.Vector3 v, float x, float y, float z, float most = 1e-6f) { return Math.Abs(v.x - x) + Math.Abs(v.y - y) + Math.Abs(v.z - z) < most; }
  static bool Near(UnityEngine.Vector3 v, UnityEngine.Vector3 w) { return Near(v, w.x, w.y, w.z, 1e-3f); }

  static void Call(OdographProvider provider, string name) { typeof(OdographProvider).GetMethod(name, BindingFlags.NonPublic | BindingFlags.Instance).Invoke(provider, null); }

  /// Walks through the recording, in a session that works within each push.
  static void Walk(OdographProvider provider, string file) {
    var session = new Odograph.Session(provider.Config);
    typeof(OdographProvider).GetField("session", BindingFlags.NonPublic | BindingFlags.Instance).SetValue(provider, session);
    using (var recording = new Odograph.Recording(file)) {
      Odograph.Event message;
      IntPtr pgm;
      int size;
      while (recording.Next(out message, out pgm, out size)) {
        Odograph.Imu imu;
        Odograph.Frame frame;
        Odograph.Calibration calibration;
        if (message.TryGet(out imu)) provider.OnImu(imu.header.t_ns, imu.gyro_b, imu.accel_b);
        if (message.TryGet(out calibration)) provider.OnLens(ref calibration);
        if (!message.TryGet(out frame)) continue;
        var head = new byte[24];
        Marshal.Copy(pgm, head, 0, head.Length);
        string[] words = Encoding.ASCII.GetString(head).Split(' ', '\n');
        int width = int.Parse(words[1]), height = int.Parse(words[2]);
        provider.OnPicture(frame.header.t_ns, width, height, pixels => Marshal.Copy(pgm + size - width * height, pixels, 0, width * height));
      }
    }
    session.Flush();
    Call(provider, "LateUpdate");
  }

  static int Main(string[] args) {
    // An upright camera looking north: x to the east, y down, z to the north. R = [0 0 1; 1 0 0; 0 1 0], q = (1, 1, 1,
    // 1) / 2.
    UnityEngine.Quaternion q = OdographProvider.Turned(new Odograph.Rotation(0.5, 0.5, 0.5, 0.5));
    bool good = Near(OdographProvider.Place(new Odograph.Vector(1, 2, 3)), 2, -3, 1) && Near(q.Ahead, 0, 0, 1) && Near(q.Up, 0, 1, 0);
    if (!good) return 1;

    // A tap whose ray points 45 degrees down to the north hits the floor there, and an anchor stays there.
    var provider = new OdographProvider();
    Walk(provider, args[0]);
    var hits = new List<OdographHit>();
    UnityEngine.Vector3 eye = provider.transform.localPosition, down = new UnityEngine.Vector3(0, -0.70710678f, 0.70710678f);
    UnityEngine.Camera.Direction = down;
    if (!provider.Raycast(new UnityEngine.Vector2(), hits) || hits[0].trackableId == 0) return 2;
    OdographHit hit = hits[0];
    Console.WriteLine("floor " + -(hit.pose.position.y - eye.y) + " m below, surface " + hit.trackableId + ", sigma " + hit.sigma + " m");
    if (!Near(hit.pose.position, eye + hit.distance * down) || !(Math.Abs(hit.distance * 0.7071f - 1.3f) < 0.15f)) return 3;
    if (!Near(hit.pose.rotation.Up, 0, 1, 0, 0.1f) || !Near(hit.pose.rotation.Ahead, 0, 0, 1, 0.1f) || !(hit.sigma > 0)) return 4;
    ulong anchor = provider.AddAnchor(hit, "a label");
    UnityEngine.Pose pose;
    if (!provider.TryGetAnchor(anchor, out pose) || !Near(pose.position, hit.pose.position) || !Near(pose.rotation.Up, hit.pose.rotation.Up)) return 5;

    provider.Raycast(new UnityEngine.Vector2(), hits, Odograph.Abi.ODO_HIT_POINT);
    if (hits.Exists(other => other.hitType != Odograph.Abi.ODO_HIT_POINT)) return 6;
    UnityEngine.Camera.Direction = new UnityEngine.Vector3(0, 1, 0);
    if (provider.Raycast(new UnityEngine.Vector2(), hits) || hits.Count != 0) return 7;  // nothing above
    Call(provider, "OnDisable");
    return 0;
  }
}
