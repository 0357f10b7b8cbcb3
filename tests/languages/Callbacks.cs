// SPDX-License-Identifier: Apache-2.0
// What a handler throws comes out of Push once, and events go on; it cannot dispose of the session. A picture outside its array is
// refused. A map of an earlier session, which is the argument, is saved as it was.
using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using Odograph;

static class Callbacks {
  static void Expect(bool holds, string what) {
    if (!holds) throw new Exception("not so: " + what);
  }

  static void Try(bool live) {
    int seen = 0;
    var thrown = new List<Exception>();
    using (var session = new Session("odograph: 1\nattitude: {plugin: attitude/vqf}\n", live)) {
      session.Listen(message => {
        ++seen;
        if (seen == 20) throw new NotSupportedException("once");
        if (seen == 200) session.Dispose();
      });
      for (int i = 0; i < 400; ++i)
        try {
          session.PushImu(1000000000L + i * 5000000L, new Vector(0, 0.01, 0), new Vector(0.1, 9.81, 0.4));
          if (i % 50 == 49) session.Flush();
        } catch (Exception e) {
          thrown.Add(e);
        }
    }
    Expect(seen > 300, "events " + seen);
    Expect(thrown.Count == 2 && thrown[0] is NotSupportedException && thrown[1] is InvalidOperationException, string.Join("; ", thrown));
  }

  static void Main(string[] arguments) {
    Try(false);
    Try(true);
    using (var session = new Session("odograph: 1\nattitude: {plugin: attitude/vqf}\n"))
    using (var picture = new Picture(640 * 480))
      foreach (int[] wrong in new[] {new[] {0, -640}, new[] {-1, 640}, new[] {0, 639}, new[] {1, 640}}) {
        var frame = new Frame(1) {format = Abi.ODO_FORMAT_GREY8, width = 640, height = 480};
        try {
          session.PushFrame(ref frame, picture, wrong[0], wrong[1]);
          Expect(false, "begin " + wrong[0] + ", stride " + wrong[1] + " was refused");
        } catch (ArgumentException) {
        }
      }
    using (var session = new Session("odograph: 1\nattitude: {plugin: attitude/vqf}\nabsolute_fixers: {plugin: fix/map}\n")) {
      byte[] map = File.ReadAllBytes(arguments[0]);
      Expect(session.SaveMap().Length == 0, "there is a map before");
      try {
        session.LoadMap(new byte[] {1, 2, 3});
        Expect(false, "a damaged map was refused");
      } catch (OdographException) {
      }
      session.LoadMap(map);
      Expect(session.SaveMap().SequenceEqual(map), "the same map");
    }
  }
}
