// SPDX-License-Identifier: Apache-2.0
package android.app;
import android.content.Context;
import android.os.Bundle;
import android.view.View;
import android.view.Window;
public class Activity extends Context {
  public Window getWindow() { return null; }
  public void setContentView(View view) {}
  public final void requestPermissions(String[] permissions, int code) {}
  protected void onCreate(Bundle state) {}
  protected void onResume() {}
  protected void onPause() {}
}
