// SPDX-License-Identifier: Apache-2.0
// A sketch of Odograph as the source of a camera's pose in Unity, and of hits for content that is placed by a tap. It
// is compiled against our own declarations (ctest -R languages) and has not been run in Unity. README.md has the steps.
using System;
using System.Collections.Generic;
using Odograph;
using UnityEngine;
using Pose = UnityEngine.Pose;  // Odograph has a Pose too
using Ray = UnityEngine.Ray;    // and a Ray

/// As ARRaycastHit.
public struct OdographHit {
  public Pose pose;          // up is the normal of what was hit, forward points away from the camera
  public float distance;     // from the camera, m
  public float sigma;        // its standard deviation
  public ulong trackableId;  // of the surface, 0: none
  public uint hitType;       // Abi.ODO_HIT_SURFACE, _POINT or _FLOOR
  internal Hit hit;
}

public sealed class OdographProvider : MonoBehaviour {
  [TextArea] public string Config = "odograph: 1\nwalker: {height: 1.70 m}\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n" +
                                    "vo_frontend: {plugin: vo/odograph}\nsurface_finder: {plugin: surface/planes}\ncoupling: {type: localizer}\n";
  public string PluginPath = "";
  public long ScreenDelay_ns = 30000000;  // from the newest sample to the light of the screen
  public uint State { get; private set; }

  Session session;
  PicturePool pictures;
  Frame frame;
  readonly Hit[] found = new Hit[8];
  long shown_ns;

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
    Odograph.Pose pose;
    if (!session.TryGetPose(out pose) || !session.TryGetPose(out pose, pose.header.t_ns + ScreenDelay_ns, smooth: true)) return;
    State = pose.state;
    shown_ns = pose.header.t_ns;
    if ((pose.header.flags & Abi.ODO_POSE_POSITION) != 0) transform.localPosition = Place(pose.p_n);
    // Without a camera the orientation is that of the phone's axes, which Turned does not convert.
    if ((pose.header.flags & Abi.ODO_POSE_CAMERA) != 0) transform.localRotation = Turned(pose.q_n);
  }

  /// As ARRaycastManager.Raycast: what lies behind a point of the screen, nearest first; false if nothing is known there.
  /// `types`: Abi.ODO_HIT_*, any of them; 0: all. The camera's field of view must be that of the picture shown behind.
  public bool Raycast(Vector2 screenPoint, List<OdographHit> hits, uint types = 0) {
    return Raycast(GetComponent<Camera>().ScreenPointToRay(screenPoint), hits, types);
  }

  /// As above, for a ray through the camera. It is cast from the camera's own position, not from the near plane.
  public bool Raycast(Ray ray, List<OdographHit> hits, uint types = 0) {
    hits.Clear();
    int count = session.HitTest(new Odograph.Ray {kind = Abi.ODO_RAY_WORLD, world = Abi.ODO_WORLD_SMOOTH, t_ns = shown_ns, wanted = types,
                                                  origin = FromUnity(transform.localPosition), direction = FromUnity(ray.direction)}, found);
    for (int i = 0; i < count; ++i)
      hits.Add(new OdographHit {pose = PoseOf(found[i].q_n, found[i].p_n), distance = (float)found[i].distance_m, sigma = (float)found[i].sigma_m,
                                trackableId = found[i].surface, hitType = found[i].what, hit = found[i]});
    return count > 0;
  }

  /// An anchor where a ray hit, which stays fixed to the surface: its id, 0 while the position is unknown.
  public ulong AddAnchor(OdographHit hit, string name = "") { return session.CreateAnchor(Session.PlaceOf(hit.hit, Abi.ODO_WORLD_SMOOTH), name); }

  /// Where to draw it in this frame: call it after the camera has moved. False while it is not placed.
  public bool TryGetAnchor(ulong id, out Pose pose) {
    Anchor anchor;
    bool placed = session.TryGetAnchor(id, out anchor, shown_ns, Abi.ODO_WORLD_SMOOTH) && (anchor.flags & Abi.ODO_ANCHOR_PLACED) != 0;
    pose = placed ? PoseOf(anchor.q_n, anchor.p_n) : default(Pose);
    return placed;
  }

  /// North-East-Down to Unity's left-handed x right, y up, z ahead: east, up, north.
  public static Vector3 Place(Vector p) { return new Vector3((float)p.y, (float)-p.z, (float)p.x); }
  static Vector FromUnity(Vector3 v) { return new Vector(v.z, v.x, -v.y); }

  /// The camera looks along z in both conventions; its y axis points down in Odograph and up in Unity.
  public static Quaternion Turned(Rotation q) { return Facing(q, new Vector(0, 0, 1), new Vector(0, -1, 0)); }

  /// A hit's axes, and those of an anchor made from it: z is the normal, x points away from the camera.
  static Pose PoseOf(Rotation q, Vector p) { return new Pose(Place(p), Facing(q, new Vector(1, 0, 0), new Vector(0, 0, 1))); }

  static Quaternion Facing(Rotation q, Vector ahead, Vector up) { return Quaternion.LookRotation(Place(Rotate(q, ahead)), Place(Rotate(q, up))); }

  static Vector Rotate(Rotation q, Vector v) {
    double tx = 2 * (q.y * v.z - q.z * v.y), ty = 2 * (q.z * v.x - q.x * v.z), tz = 2 * (q.x * v.y - q.y * v.x);
    return new Vector(v.x + q.w * tx + q.y * tz - q.z * ty, v.y + q.w * ty + q.z * tx - q.x * tz, v.z + q.w * tz + q.x * ty - q.y * tx);
  }
}
