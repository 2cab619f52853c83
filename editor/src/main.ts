import "./page.css";
import { start } from "./shell.js";

void start(document.getElementById("shell")!);
