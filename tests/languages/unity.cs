// SPDX-License-Identifier: Apache-2.0
// The part of UnityEngine that samples/unity uses, and tests of its conversions.
using System;

namespace UnityEngine {
  public class TextAreaAttribute : Attribute {}
  public struct Vector3 {
    public float x, y, z;
    public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
  }
  public struct Quaternion {
    public Vector3 Ahead, Up;
    public static Quaternion LookRotation(Vector3 ahead, Vector3 up) { return new Quaternion {Ahead = ahead, Up = up}; }
  }
  public class Transform {
    public Vector3 localPosition;
    public Quaternion localRotation;
  }
  public class MonoBehaviour {
    public Transform transform = new Transform();
  }
}

static class UnityConversions {
  static bool Near(UnityEngine.Vector3 v, float x, float y, float z) { return Math.Abs(v.x - x) + Math.Abs(v.y - y) + Math.Abs(v.z - z) < 1e-6; }

  static int Main() {
    // An upright camera looking north: x to the east, y down, z to the north. R = [0 0 1; 1 0 0; 0 1 0], q = (1, 1, 1,
    // 1) / 2.
    UnityEngine.Quaternion q = OdographProvider.Turned(new Odograph.Rotation(0.5, 0.5, 0.5, 0.5));
    bool good = Near(OdographProvider.Place(new Odograph.Vector(1, 2, 3)), 2, -3, 1) && Near(q.Ahead, 0, 0, 1) && Near(q.Up, 0, 1, 0);
    return good ? 0 : 1;
  }
}
