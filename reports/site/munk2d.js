// Munk2D of pymunk 7.3.1, sources 6fae72f83ba28517
/*
Copyright (c) 2025 Victor Blomqvist
Copyright (c) 2007-2024 Scott Lembcke and Howling Moon Software

Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in
all copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
SOFTWARE.
*/

var Module = (() => {
  var _scriptDir = import.meta.url;
  
  return (
function(Module) {
  Module = Module || {};



// The Module object: Our interface to the outside world. We import
// and export values on it. There are various ways Module can be used:
// 1. Not defined. We create it here
// 2. A function parameter, function(Module) { ..generated code.. }
// 3. pre-run appended it, var Module = {}; ..generated code..
// 4. External script tag defines var Module.
// We need to check if Module already exists (e.g. case 3 above).
// Substitution will be replaced with actual code on later stage of the build,
// this way Closure Compiler will not mangle it (e.g. case 4. above).
// Note that if you want to run closure, and also to use Module
// after the generated code, you will need to define   var Module = {};
// before the code. Then that object will be used in the code, and you
// can continue to use Module afterwards as well.
var Module = typeof Module != 'undefined' ? Module : {};

// See https://caniuse.com/mdn-javascript_builtins_object_assign

// Set up the promise that indicates the Module is initialized
var readyPromiseResolve, readyPromiseReject;
Module['ready'] = new Promise(function(resolve, reject) {
  readyPromiseResolve = resolve;
  readyPromiseReject = reject;
});

// --pre-jses are emitted after the Module integration code, so that they can
// refer to Module (if they choose; they can also define Module)
// {{PRE_JSES}}

// Sometimes an existing Module object exists with properties
// meant to overwrite the default module functionality. Here
// we collect those properties and reapply _after_ we configure
// the current environment's defaults to avoid having to be so
// defensive during initialization.
var moduleOverrides = Object.assign({}, Module);

var arguments_ = [];
var thisProgram = './this.program';
var quit_ = (status, toThrow) => {
  throw toThrow;
};

// Determine the runtime environment we are in. You can customize this by
// setting the ENVIRONMENT setting at compile time (see settings.js).

// Attempt to auto-detect the environment
var ENVIRONMENT_IS_WEB = typeof window == 'object';
var ENVIRONMENT_IS_WORKER = typeof importScripts == 'function';
// N.b. Electron.js environment is simultaneously a NODE-environment, but
// also a web environment.
var ENVIRONMENT_IS_NODE = typeof process == 'object' && typeof process.versions == 'object' && typeof process.versions.node == 'string';
var ENVIRONMENT_IS_SHELL = !ENVIRONMENT_IS_WEB && !ENVIRONMENT_IS_NODE && !ENVIRONMENT_IS_WORKER;

// `/` should be present at the end if `scriptDirectory` is not empty
var scriptDirectory = '';
function locateFile(path) {
  if (Module['locateFile']) {
    return Module['locateFile'](path, scriptDirectory);
  }
  return scriptDirectory + path;
}

// Hooks that are implemented differently in different runtime environments.
var read_,
    readAsync,
    readBinary,
    setWindowTitle;

// Note that this includes Node.js workers when relevant (pthreads is enabled).
// Node.js workers are detected as a combination of ENVIRONMENT_IS_WORKER and
// ENVIRONMENT_IS_NODE.
if (ENVIRONMENT_IS_WEB || ENVIRONMENT_IS_WORKER) {
  if (ENVIRONMENT_IS_WORKER) { // Check worker, not web, since window could be polyfilled
    scriptDirectory = self.location.href;
  } else if (typeof document != 'undefined' && document.currentScript) { // web
    scriptDirectory = document.currentScript.src;
  }
  // When MODULARIZE, this JS may be executed later, after document.currentScript
  // is gone, so we saved it, and we use it here instead of any other info.
  if (_scriptDir) {
    scriptDirectory = _scriptDir;
  }
  // blob urls look like blob:http://site.com/etc/etc and we cannot infer anything from them.
  // otherwise, slice off the final part of the url to find the script directory.
  // if scriptDirectory does not contain a slash, lastIndexOf will return -1,
  // and scriptDirectory will correctly be replaced with an empty string.
  // If scriptDirectory contains a query (starting with ?) or a fragment (starting with #),
  // they are removed because they could contain a slash.
  if (scriptDirectory.indexOf('blob:') !== 0) {
    scriptDirectory = scriptDirectory.substr(0, scriptDirectory.replace(/[?#].*/, "").lastIndexOf('/')+1);
  } else {
    scriptDirectory = '';
  }

  // Differentiate the Web Worker from the Node Worker case, as reading must
  // be done differently.
  {
// include: web_or_worker_shell_read.js


  read_ = (url) => {
    try {
      var xhr = new XMLHttpRequest();
      xhr.open('GET', url, false);
      xhr.send(null);
      return xhr.responseText;
    } catch (err) {
      var data = tryParseAsDataURI(url);
      if (data) {
        return intArrayToString(data);
      }
      throw err;
    }
  }

  if (ENVIRONMENT_IS_WORKER) {
    readBinary = (url) => {
      try {
        var xhr = new XMLHttpRequest();
        xhr.open('GET', url, false);
        xhr.responseType = 'arraybuffer';
        xhr.send(null);
        return new Uint8Array(/** @type{!ArrayBuffer} */(xhr.response));
      } catch (err) {
        var data = tryParseAsDataURI(url);
        if (data) {
          return data;
        }
        throw err;
      }
    };
  }

  readAsync = (url, onload, onerror) => {
    var xhr = new XMLHttpRequest();
    xhr.open('GET', url, true);
    xhr.responseType = 'arraybuffer';
    xhr.onload = () => {
      if (xhr.status == 200 || (xhr.status == 0 && xhr.response)) { // file URLs can return 0
        onload(xhr.response);
        return;
      }
      var data = tryParseAsDataURI(url);
      if (data) {
        onload(data.buffer);
        return;
      }
      onerror();
    };
    xhr.onerror = onerror;
    xhr.send(null);
  }

// end include: web_or_worker_shell_read.js
  }

  setWindowTitle = (title) => document.title = title;
} else
{
}

var out = Module['print'] || console.log.bind(console);
var err = Module['printErr'] || console.warn.bind(console);

// Merge back in the overrides
Object.assign(Module, moduleOverrides);
// Free the object hierarchy contained in the overrides, this lets the GC
// reclaim data used e.g. in memoryInitializerRequest, which is a large typed array.
moduleOverrides = null;

// Emit code to handle expected values on the Module object. This applies Module.x
// to the proper local x. This has two benefits: first, we only emit it if it is
// expected to arrive, and second, by using a local everywhere else that can be
// minified.

if (Module['arguments']) arguments_ = Module['arguments'];

if (Module['thisProgram']) thisProgram = Module['thisProgram'];

if (Module['quit']) quit_ = Module['quit'];

// perform assertions in shell.js after we set up out() and err(), as otherwise if an assertion fails it cannot print the message




var STACK_ALIGN = 16;
var POINTER_SIZE = 4;

function getNativeTypeSize(type) {
  switch (type) {
    case 'i1': case 'i8': return 1;
    case 'i16': return 2;
    case 'i32': return 4;
    case 'i64': return 8;
    case 'float': return 4;
    case 'double': return 8;
    default: {
      if (type[type.length - 1] === '*') {
        return POINTER_SIZE;
      } else if (type[0] === 'i') {
        const bits = Number(type.substr(1));
        assert(bits % 8 === 0, 'getNativeTypeSize invalid bits ' + bits + ', type ' + type);
        return bits / 8;
      } else {
        return 0;
      }
    }
  }
}

function warnOnce(text) {
  if (!warnOnce.shown) warnOnce.shown = {};
  if (!warnOnce.shown[text]) {
    warnOnce.shown[text] = 1;
    err(text);
  }
}

// include: runtime_functions.js


// Wraps a JS function as a wasm function with a given signature.
function convertJsFunctionToWasm(func, sig) {

  // If the type reflection proposal is available, use the new
  // "WebAssembly.Function" constructor.
  // Otherwise, construct a minimal wasm module importing the JS function and
  // re-exporting it.
  if (typeof WebAssembly.Function == "function") {
    var typeNames = {
      'i': 'i32',
      'j': 'i64',
      'f': 'f32',
      'd': 'f64'
    };
    var type = {
      parameters: [],
      results: sig[0] == 'v' ? [] : [typeNames[sig[0]]]
    };
    for (var i = 1; i < sig.length; ++i) {
      type.parameters.push(typeNames[sig[i]]);
    }
    return new WebAssembly.Function(type, func);
  }

  // The module is static, with the exception of the type section, which is
  // generated based on the signature passed in.
  var typeSection = [
    0x01, // id: section,
    0x00, // length: 0 (placeholder)
    0x01, // count: 1
    0x60, // form: func
  ];
  var sigRet = sig.slice(0, 1);
  var sigParam = sig.slice(1);
  var typeCodes = {
    'i': 0x7f, // i32
    'j': 0x7e, // i64
    'f': 0x7d, // f32
    'd': 0x7c, // f64
  };

  // Parameters, length + signatures
  typeSection.push(sigParam.length);
  for (var i = 0; i < sigParam.length; ++i) {
    typeSection.push(typeCodes[sigParam[i]]);
  }

  // Return values, length + signatures
  // With no multi-return in MVP, either 0 (void) or 1 (anything else)
  if (sigRet == 'v') {
    typeSection.push(0x00);
  } else {
    typeSection = typeSection.concat([0x01, typeCodes[sigRet]]);
  }

  // Write the overall length of the type section back into the section header
  // (excepting the 2 bytes for the section id and length)
  typeSection[1] = typeSection.length - 2;

  // Rest of the module is static
  var bytes = new Uint8Array([
    0x00, 0x61, 0x73, 0x6d, // magic ("\0asm")
    0x01, 0x00, 0x00, 0x00, // version: 1
  ].concat(typeSection, [
    0x02, 0x07, // import section
      // (import "e" "f" (func 0 (type 0)))
      0x01, 0x01, 0x65, 0x01, 0x66, 0x00, 0x00,
    0x07, 0x05, // export section
      // (export "f" (func 0 (type 0)))
      0x01, 0x01, 0x66, 0x00, 0x00,
  ]));

   // We can compile this wasm module synchronously because it is very small.
  // This accepts an import (at "e.f"), that it reroutes to an export (at "f")
  var module = new WebAssembly.Module(bytes);
  var instance = new WebAssembly.Instance(module, {
    'e': {
      'f': func
    }
  });
  var wrappedFunc = instance.exports['f'];
  return wrappedFunc;
}

var freeTableIndexes = [];

// Weak map of functions in the table to their indexes, created on first use.
var functionsInTableMap;

function getEmptyTableSlot() {
  // Reuse a free index if there is one, otherwise grow.
  if (freeTableIndexes.length) {
    return freeTableIndexes.pop();
  }
  // Grow the table
  try {
    wasmTable.grow(1);
  } catch (err) {
    if (!(err instanceof RangeError)) {
      throw err;
    }
    throw 'Unable to grow wasm table. Set ALLOW_TABLE_GROWTH.';
  }
  return wasmTable.length - 1;
}

function updateTableMap(offset, count) {
  for (var i = offset; i < offset + count; i++) {
    var item = getWasmTableEntry(i);
    // Ignore null values.
    if (item) {
      functionsInTableMap.set(item, i);
    }
  }
}

/**
 * Add a function to the table.
 * 'sig' parameter is required if the function being added is a JS function.
 * @param {string=} sig
 */
function addFunction(func, sig) {

  // Check if the function is already in the table, to ensure each function
  // gets a unique index. First, create the map if this is the first use.
  if (!functionsInTableMap) {
    functionsInTableMap = new WeakMap();
    updateTableMap(0, wasmTable.length);
  }
  if (functionsInTableMap.has(func)) {
    return functionsInTableMap.get(func);
  }

  // It's not in the table, add it now.

  var ret = getEmptyTableSlot();

  // Set the new value.
  try {
    // Attempting to call this with JS function will cause of table.set() to fail
    setWasmTableEntry(ret, func);
  } catch (err) {
    if (!(err instanceof TypeError)) {
      throw err;
    }
    var wrapped = convertJsFunctionToWasm(func, sig);
    setWasmTableEntry(ret, wrapped);
  }

  functionsInTableMap.set(func, ret);

  return ret;
}

function removeFunction(index) {
  functionsInTableMap.delete(getWasmTableEntry(index));
  freeTableIndexes.push(index);
}

// end include: runtime_functions.js
// include: runtime_debug.js


// end include: runtime_debug.js
var tempRet0 = 0;
var setTempRet0 = (value) => { tempRet0 = value; };
var getTempRet0 = () => tempRet0;



// === Preamble library stuff ===

// Documentation for the public APIs defined in this file must be updated in:
//    site/source/docs/api_reference/preamble.js.rst
// A prebuilt local version of the documentation is available at:
//    site/build/text/docs/api_reference/preamble.js.txt
// You can also build docs locally as HTML or other formats in site/
// An online HTML version (which may be of a different version of Emscripten)
//    is up at http://kripken.github.io/emscripten-site/docs/api_reference/preamble.js.html

var wasmBinary;
if (Module['wasmBinary']) wasmBinary = Module['wasmBinary'];
var noExitRuntime = Module['noExitRuntime'] || true;

if (typeof WebAssembly != 'object') {
  abort('no native wasm support detected');
}

// include: runtime_safe_heap.js


// In MINIMAL_RUNTIME, setValue() and getValue() are only available when building with safe heap enabled, for heap safety checking.
// In traditional runtime, setValue() and getValue() are always available (although their use is highly discouraged due to perf penalties)

/** @param {number} ptr
    @param {number} value
    @param {string} type
    @param {number|boolean=} noSafe */
function setValue(ptr, value, type = 'i8', noSafe) {
  if (type.charAt(type.length-1) === '*') type = 'i32';
    switch (type) {
      case 'i1': HEAP8[((ptr)>>0)] = value; break;
      case 'i8': HEAP8[((ptr)>>0)] = value; break;
      case 'i16': HEAP16[((ptr)>>1)] = value; break;
      case 'i32': HEAP32[((ptr)>>2)] = value; break;
      case 'i64': (tempI64 = [value>>>0,(tempDouble=value,(+(Math.abs(tempDouble))) >= 1.0 ? (tempDouble > 0.0 ? ((Math.min((+(Math.floor((tempDouble)/4294967296.0))), 4294967295.0))|0)>>>0 : (~~((+(Math.ceil((tempDouble - +(((~~(tempDouble)))>>>0))/4294967296.0)))))>>>0) : 0)],HEAP32[((ptr)>>2)] = tempI64[0],HEAP32[(((ptr)+(4))>>2)] = tempI64[1]); break;
      case 'float': HEAPF32[((ptr)>>2)] = value; break;
      case 'double': HEAPF64[((ptr)>>3)] = value; break;
      default: abort('invalid type for setValue: ' + type);
    }
}

/** @param {number} ptr
    @param {string} type
    @param {number|boolean=} noSafe */
function getValue(ptr, type = 'i8', noSafe) {
  if (type.charAt(type.length-1) === '*') type = 'i32';
    switch (type) {
      case 'i1': return HEAP8[((ptr)>>0)];
      case 'i8': return HEAP8[((ptr)>>0)];
      case 'i16': return HEAP16[((ptr)>>1)];
      case 'i32': return HEAP32[((ptr)>>2)];
      case 'i64': return HEAP32[((ptr)>>2)];
      case 'float': return HEAPF32[((ptr)>>2)];
      case 'double': return Number(HEAPF64[((ptr)>>3)]);
      default: abort('invalid type for getValue: ' + type);
    }
  return null;
}

// end include: runtime_safe_heap.js
// Wasm globals

var wasmMemory;

//========================================
// Runtime essentials
//========================================

// whether we are quitting the application. no code should run after this.
// set in exit() and abort()
var ABORT = false;

// set by exit() and abort().  Passed to 'onExit' handler.
// NOTE: This is also used as the process return code code in shell environments
// but only when noExitRuntime is false.
var EXITSTATUS;

/** @type {function(*, string=)} */
function assert(condition, text) {
  if (!condition) {
    // This build was created without ASSERTIONS defined.  `assert()` should not
    // ever be called in this configuration but in case there are callers in
    // the wild leave this simple abort() implemenation here for now.
    abort(text);
  }
}

// Returns the C function with a specified identifier (for C++, you need to do manual name mangling)
function getCFunc(ident) {
  var func = Module['_' + ident]; // closure exported function
  return func;
}

// C calling interface.
/** @param {string|null=} returnType
    @param {Array=} argTypes
    @param {Arguments|Array=} args
    @param {Object=} opts */
function ccall(ident, returnType, argTypes, args, opts) {
  // For fast lookup of conversion functions
  var toC = {
    'string': function(str) {
      var ret = 0;
      if (str !== null && str !== undefined && str !== 0) { // null string
        // at most 4 bytes per UTF-8 code point, +1 for the trailing '\0'
        var len = (str.length << 2) + 1;
        ret = stackAlloc(len);
        stringToUTF8(str, ret, len);
      }
      return ret;
    },
    'array': function(arr) {
      var ret = stackAlloc(arr.length);
      writeArrayToMemory(arr, ret);
      return ret;
    }
  };

  function convertReturnValue(ret) {
    if (returnType === 'string') return UTF8ToString(ret);
    if (returnType === 'boolean') return Boolean(ret);
    return ret;
  }

  var func = getCFunc(ident);
  var cArgs = [];
  var stack = 0;
  if (args) {
    for (var i = 0; i < args.length; i++) {
      var converter = toC[argTypes[i]];
      if (converter) {
        if (stack === 0) stack = stackSave();
        cArgs[i] = converter(args[i]);
      } else {
        cArgs[i] = args[i];
      }
    }
  }
  var ret = func.apply(null, cArgs);
  function onDone(ret) {
    if (stack !== 0) stackRestore(stack);
    return convertReturnValue(ret);
  }

  ret = onDone(ret);
  return ret;
}

/** @param {string=} returnType
    @param {Array=} argTypes
    @param {Object=} opts */
function cwrap(ident, returnType, argTypes, opts) {
  argTypes = argTypes || [];
  // When the function takes numbers and returns a number, we can just return
  // the original function
  var numericArgs = argTypes.every(function(type){ return type === 'number'});
  var numericRet = returnType !== 'string';
  if (numericRet && numericArgs && !opts) {
    return getCFunc(ident);
  }
  return function() {
    return ccall(ident, returnType, argTypes, arguments, opts);
  }
}

// include: runtime_legacy.js


var ALLOC_NORMAL = 0; // Tries to use _malloc()
var ALLOC_STACK = 1; // Lives for the duration of the current function call

/**
 * allocate(): This function is no longer used by emscripten but is kept around to avoid
 *             breaking external users.
 *             You should normally not use allocate(), and instead allocate
 *             memory using _malloc()/stackAlloc(), initialize it with
 *             setValue(), and so forth.
 * @param {(Uint8Array|Array<number>)} slab: An array of data.
 * @param {number=} allocator : How to allocate memory, see ALLOC_*
 */
function allocate(slab, allocator) {
  var ret;

  if (allocator == ALLOC_STACK) {
    ret = stackAlloc(slab.length);
  } else {
    ret = _malloc(slab.length);
  }

  if (!slab.subarray && !slab.slice) {
    slab = new Uint8Array(slab);
  }
  HEAPU8.set(slab, ret);
  return ret;
}

// end include: runtime_legacy.js
// include: runtime_strings.js


// runtime_strings.js: Strings related runtime functions that are part of both MINIMAL_RUNTIME and regular runtime.

// Given a pointer 'ptr' to a null-terminated UTF8-encoded string in the given array that contains uint8 values, returns
// a copy of that string as a Javascript String object.

var UTF8Decoder = typeof TextDecoder != 'undefined' ? new TextDecoder('utf8') : undefined;

/**
 * @param {number} idx
 * @param {number=} maxBytesToRead
 * @return {string}
 */
function UTF8ArrayToString(heap, idx, maxBytesToRead) {
  var endIdx = idx + maxBytesToRead;
  var endPtr = idx;
  // TextDecoder needs to know the byte length in advance, it doesn't stop on null terminator by itself.
  // Also, use the length info to avoid running tiny strings through TextDecoder, since .subarray() allocates garbage.
  // (As a tiny code save trick, compare endPtr against endIdx using a negation, so that undefined means Infinity)
  while (heap[endPtr] && !(endPtr >= endIdx)) ++endPtr;

  if (endPtr - idx > 16 && heap.subarray && UTF8Decoder) {
    return UTF8Decoder.decode(heap.subarray(idx, endPtr));
  } else {
    var str = '';
    // If building with TextDecoder, we have already computed the string length above, so test loop end condition against that
    while (idx < endPtr) {
      // For UTF8 byte structure, see:
      // http://en.wikipedia.org/wiki/UTF-8#Description
      // https://www.ietf.org/rfc/rfc2279.txt
      // https://tools.ietf.org/html/rfc3629
      var u0 = heap[idx++];
      if (!(u0 & 0x80)) { str += String.fromCharCode(u0); continue; }
      var u1 = heap[idx++] & 63;
      if ((u0 & 0xE0) == 0xC0) { str += String.fromCharCode(((u0 & 31) << 6) | u1); continue; }
      var u2 = heap[idx++] & 63;
      if ((u0 & 0xF0) == 0xE0) {
        u0 = ((u0 & 15) << 12) | (u1 << 6) | u2;
      } else {
        u0 = ((u0 & 7) << 18) | (u1 << 12) | (u2 << 6) | (heap[idx++] & 63);
      }

      if (u0 < 0x10000) {
        str += String.fromCharCode(u0);
      } else {
        var ch = u0 - 0x10000;
        str += String.fromCharCode(0xD800 | (ch >> 10), 0xDC00 | (ch & 0x3FF));
      }
    }
  }
  return str;
}

// Given a pointer 'ptr' to a null-terminated UTF8-encoded string in the emscripten HEAP, returns a
// copy of that string as a Javascript String object.
// maxBytesToRead: an optional length that specifies the maximum number of bytes to read. You can omit
//                 this parameter to scan the string until the first \0 byte. If maxBytesToRead is
//                 passed, and the string at [ptr, ptr+maxBytesToReadr[ contains a null byte in the
//                 middle, then the string will cut short at that byte index (i.e. maxBytesToRead will
//                 not produce a string of exact length [ptr, ptr+maxBytesToRead[)
//                 N.B. mixing frequent uses of UTF8ToString() with and without maxBytesToRead may
//                 throw JS JIT optimizations off, so it is worth to consider consistently using one
//                 style or the other.
/**
 * @param {number} ptr
 * @param {number=} maxBytesToRead
 * @return {string}
 */
function UTF8ToString(ptr, maxBytesToRead) {
  ;
  return ptr ? UTF8ArrayToString(HEAPU8, ptr, maxBytesToRead) : '';
}

// Copies the given Javascript String object 'str' to the given byte array at address 'outIdx',
// encoded in UTF8 form and null-terminated. The copy will require at most str.length*4+1 bytes of space in the HEAP.
// Use the function lengthBytesUTF8 to compute the exact number of bytes (excluding null terminator) that this function will write.
// Parameters:
//   str: the Javascript string to copy.
//   heap: the array to copy to. Each index in this array is assumed to be one 8-byte element.
//   outIdx: The starting offset in the array to begin the copying.
//   maxBytesToWrite: The maximum number of bytes this function can write to the array.
//                    This count should include the null terminator,
//                    i.e. if maxBytesToWrite=1, only the null terminator will be written and nothing else.
//                    maxBytesToWrite=0 does not write any bytes to the output, not even the null terminator.
// Returns the number of bytes written, EXCLUDING the null terminator.

function stringToUTF8Array(str, heap, outIdx, maxBytesToWrite) {
  if (!(maxBytesToWrite > 0)) // Parameter maxBytesToWrite is not optional. Negative values, 0, null, undefined and false each don't write out any bytes.
    return 0;

  var startIdx = outIdx;
  var endIdx = outIdx + maxBytesToWrite - 1; // -1 for string null terminator.
  for (var i = 0; i < str.length; ++i) {
    // Gotcha: charCodeAt returns a 16-bit word that is a UTF-16 encoded code unit, not a Unicode code point of the character! So decode UTF16->UTF32->UTF8.
    // See http://unicode.org/faq/utf_bom.html#utf16-3
    // For UTF8 byte structure, see http://en.wikipedia.org/wiki/UTF-8#Description and https://www.ietf.org/rfc/rfc2279.txt and https://tools.ietf.org/html/rfc3629
    var u = str.charCodeAt(i); // possibly a lead surrogate
    if (u >= 0xD800 && u <= 0xDFFF) {
      var u1 = str.charCodeAt(++i);
      u = 0x10000 + ((u & 0x3FF) << 10) | (u1 & 0x3FF);
    }
    if (u <= 0x7F) {
      if (outIdx >= endIdx) break;
      heap[outIdx++] = u;
    } else if (u <= 0x7FF) {
      if (outIdx + 1 >= endIdx) break;
      heap[outIdx++] = 0xC0 | (u >> 6);
      heap[outIdx++] = 0x80 | (u & 63);
    } else if (u <= 0xFFFF) {
      if (outIdx + 2 >= endIdx) break;
      heap[outIdx++] = 0xE0 | (u >> 12);
      heap[outIdx++] = 0x80 | ((u >> 6) & 63);
      heap[outIdx++] = 0x80 | (u & 63);
    } else {
      if (outIdx + 3 >= endIdx) break;
      heap[outIdx++] = 0xF0 | (u >> 18);
      heap[outIdx++] = 0x80 | ((u >> 12) & 63);
      heap[outIdx++] = 0x80 | ((u >> 6) & 63);
      heap[outIdx++] = 0x80 | (u & 63);
    }
  }
  // Null-terminate the pointer to the buffer.
  heap[outIdx] = 0;
  return outIdx - startIdx;
}

// Copies the given Javascript String object 'str' to the emscripten HEAP at address 'outPtr',
// null-terminated and encoded in UTF8 form. The copy will require at most str.length*4+1 bytes of space in the HEAP.
// Use the function lengthBytesUTF8 to compute the exact number of bytes (excluding null terminator) that this function will write.
// Returns the number of bytes written, EXCLUDING the null terminator.

function stringToUTF8(str, outPtr, maxBytesToWrite) {
  return stringToUTF8Array(str, HEAPU8,outPtr, maxBytesToWrite);
}

// Returns the number of bytes the given Javascript string takes if encoded as a UTF8 byte array, EXCLUDING the null terminator byte.
function lengthBytesUTF8(str) {
  var len = 0;
  for (var i = 0; i < str.length; ++i) {
    // Gotcha: charCodeAt returns a 16-bit word that is a UTF-16 encoded code unit, not a Unicode code point of the character! So decode UTF16->UTF32->UTF8.
    // See http://unicode.org/faq/utf_bom.html#utf16-3
    var u = str.charCodeAt(i); // possibly a lead surrogate
    if (u >= 0xD800 && u <= 0xDFFF) u = 0x10000 + ((u & 0x3FF) << 10) | (str.charCodeAt(++i) & 0x3FF);
    if (u <= 0x7F) ++len;
    else if (u <= 0x7FF) len += 2;
    else if (u <= 0xFFFF) len += 3;
    else len += 4;
  }
  return len;
}

// end include: runtime_strings.js
// include: runtime_strings_extra.js


// runtime_strings_extra.js: Strings related runtime functions that are available only in regular runtime.

// Given a pointer 'ptr' to a null-terminated ASCII-encoded string in the emscripten HEAP, returns
// a copy of that string as a Javascript String object.

function AsciiToString(ptr) {
  var str = '';
  while (1) {
    var ch = HEAPU8[((ptr++)>>0)];
    if (!ch) return str;
    str += String.fromCharCode(ch);
  }
}

// Copies the given Javascript String object 'str' to the emscripten HEAP at address 'outPtr',
// null-terminated and encoded in ASCII form. The copy will require at most str.length+1 bytes of space in the HEAP.

function stringToAscii(str, outPtr) {
  return writeAsciiToMemory(str, outPtr, false);
}

// Given a pointer 'ptr' to a null-terminated UTF16LE-encoded string in the emscripten HEAP, returns
// a copy of that string as a Javascript String object.

var UTF16Decoder = typeof TextDecoder != 'undefined' ? new TextDecoder('utf-16le') : undefined;

function UTF16ToString(ptr, maxBytesToRead) {
  var endPtr = ptr;
  // TextDecoder needs to know the byte length in advance, it doesn't stop on null terminator by itself.
  // Also, use the length info to avoid running tiny strings through TextDecoder, since .subarray() allocates garbage.
  var idx = endPtr >> 1;
  var maxIdx = idx + maxBytesToRead / 2;
  // If maxBytesToRead is not passed explicitly, it will be undefined, and this
  // will always evaluate to true. This saves on code size.
  while (!(idx >= maxIdx) && HEAPU16[idx]) ++idx;
  endPtr = idx << 1;

  if (endPtr - ptr > 32 && UTF16Decoder) {
    return UTF16Decoder.decode(HEAPU8.subarray(ptr, endPtr));
  } else {
    var str = '';

    // If maxBytesToRead is not passed explicitly, it will be undefined, and the for-loop's condition
    // will always evaluate to true. The loop is then terminated on the first null char.
    for (var i = 0; !(i >= maxBytesToRead / 2); ++i) {
      var codeUnit = HEAP16[(((ptr)+(i*2))>>1)];
      if (codeUnit == 0) break;
      // fromCharCode constructs a character from a UTF-16 code unit, so we can pass the UTF16 string right through.
      str += String.fromCharCode(codeUnit);
    }

    return str;
  }
}

// Copies the given Javascript String object 'str' to the emscripten HEAP at address 'outPtr',
// null-terminated and encoded in UTF16 form. The copy will require at most str.length*4+2 bytes of space in the HEAP.
// Use the function lengthBytesUTF16() to compute the exact number of bytes (excluding null terminator) that this function will write.
// Parameters:
//   str: the Javascript string to copy.
//   outPtr: Byte address in Emscripten HEAP where to write the string to.
//   maxBytesToWrite: The maximum number of bytes this function can write to the array. This count should include the null
//                    terminator, i.e. if maxBytesToWrite=2, only the null terminator will be written and nothing else.
//                    maxBytesToWrite<2 does not write any bytes to the output, not even the null terminator.
// Returns the number of bytes written, EXCLUDING the null terminator.

function stringToUTF16(str, outPtr, maxBytesToWrite) {
  // Backwards compatibility: if max bytes is not specified, assume unsafe unbounded write is allowed.
  if (maxBytesToWrite === undefined) {
    maxBytesToWrite = 0x7FFFFFFF;
  }
  if (maxBytesToWrite < 2) return 0;
  maxBytesToWrite -= 2; // Null terminator.
  var startPtr = outPtr;
  var numCharsToWrite = (maxBytesToWrite < str.length*2) ? (maxBytesToWrite / 2) : str.length;
  for (var i = 0; i < numCharsToWrite; ++i) {
    // charCodeAt returns a UTF-16 encoded code unit, so it can be directly written to the HEAP.
    var codeUnit = str.charCodeAt(i); // possibly a lead surrogate
    HEAP16[((outPtr)>>1)] = codeUnit;
    outPtr += 2;
  }
  // Null-terminate the pointer to the HEAP.
  HEAP16[((outPtr)>>1)] = 0;
  return outPtr - startPtr;
}

// Returns the number of bytes the given Javascript string takes if encoded as a UTF16 byte array, EXCLUDING the null terminator byte.

function lengthBytesUTF16(str) {
  return str.length*2;
}

function UTF32ToString(ptr, maxBytesToRead) {
  var i = 0;

  var str = '';
  // If maxBytesToRead is not passed explicitly, it will be undefined, and this
  // will always evaluate to true. This saves on code size.
  while (!(i >= maxBytesToRead / 4)) {
    var utf32 = HEAP32[(((ptr)+(i*4))>>2)];
    if (utf32 == 0) break;
    ++i;
    // Gotcha: fromCharCode constructs a character from a UTF-16 encoded code (pair), not from a Unicode code point! So encode the code point to UTF-16 for constructing.
    // See http://unicode.org/faq/utf_bom.html#utf16-3
    if (utf32 >= 0x10000) {
      var ch = utf32 - 0x10000;
      str += String.fromCharCode(0xD800 | (ch >> 10), 0xDC00 | (ch & 0x3FF));
    } else {
      str += String.fromCharCode(utf32);
    }
  }
  return str;
}

// Copies the given Javascript String object 'str' to the emscripten HEAP at address 'outPtr',
// null-terminated and encoded in UTF32 form. The copy will require at most str.length*4+4 bytes of space in the HEAP.
// Use the function lengthBytesUTF32() to compute the exact number of bytes (excluding null terminator) that this function will write.
// Parameters:
//   str: the Javascript string to copy.
//   outPtr: Byte address in Emscripten HEAP where to write the string to.
//   maxBytesToWrite: The maximum number of bytes this function can write to the array. This count should include the null
//                    terminator, i.e. if maxBytesToWrite=4, only the null terminator will be written and nothing else.
//                    maxBytesToWrite<4 does not write any bytes to the output, not even the null terminator.
// Returns the number of bytes written, EXCLUDING the null terminator.

function stringToUTF32(str, outPtr, maxBytesToWrite) {
  // Backwards compatibility: if max bytes is not specified, assume unsafe unbounded write is allowed.
  if (maxBytesToWrite === undefined) {
    maxBytesToWrite = 0x7FFFFFFF;
  }
  if (maxBytesToWrite < 4) return 0;
  var startPtr = outPtr;
  var endPtr = startPtr + maxBytesToWrite - 4;
  for (var i = 0; i < str.length; ++i) {
    // Gotcha: charCodeAt returns a 16-bit word that is a UTF-16 encoded code unit, not a Unicode code point of the character! We must decode the string to UTF-32 to the heap.
    // See http://unicode.org/faq/utf_bom.html#utf16-3
    var codeUnit = str.charCodeAt(i); // possibly a lead surrogate
    if (codeUnit >= 0xD800 && codeUnit <= 0xDFFF) {
      var trailSurrogate = str.charCodeAt(++i);
      codeUnit = 0x10000 + ((codeUnit & 0x3FF) << 10) | (trailSurrogate & 0x3FF);
    }
    HEAP32[((outPtr)>>2)] = codeUnit;
    outPtr += 4;
    if (outPtr + 4 > endPtr) break;
  }
  // Null-terminate the pointer to the HEAP.
  HEAP32[((outPtr)>>2)] = 0;
  return outPtr - startPtr;
}

// Returns the number of bytes the given Javascript string takes if encoded as a UTF16 byte array, EXCLUDING the null terminator byte.

function lengthBytesUTF32(str) {
  var len = 0;
  for (var i = 0; i < str.length; ++i) {
    // Gotcha: charCodeAt returns a 16-bit word that is a UTF-16 encoded code unit, not a Unicode code point of the character! We must decode the string to UTF-32 to the heap.
    // See http://unicode.org/faq/utf_bom.html#utf16-3
    var codeUnit = str.charCodeAt(i);
    if (codeUnit >= 0xD800 && codeUnit <= 0xDFFF) ++i; // possibly a lead surrogate, so skip over the tail surrogate.
    len += 4;
  }

  return len;
}

// Allocate heap space for a JS string, and write it there.
// It is the responsibility of the caller to free() that memory.
function allocateUTF8(str) {
  var size = lengthBytesUTF8(str) + 1;
  var ret = _malloc(size);
  if (ret) stringToUTF8Array(str, HEAP8, ret, size);
  return ret;
}

// Allocate stack space for a JS string, and write it there.
function allocateUTF8OnStack(str) {
  var size = lengthBytesUTF8(str) + 1;
  var ret = stackAlloc(size);
  stringToUTF8Array(str, HEAP8, ret, size);
  return ret;
}

// Deprecated: This function should not be called because it is unsafe and does not provide
// a maximum length limit of how many bytes it is allowed to write. Prefer calling the
// function stringToUTF8Array() instead, which takes in a maximum length that can be used
// to be secure from out of bounds writes.
/** @deprecated
    @param {boolean=} dontAddNull */
function writeStringToMemory(string, buffer, dontAddNull) {
  warnOnce('writeStringToMemory is deprecated and should not be called! Use stringToUTF8() instead!');

  var /** @type {number} */ lastChar, /** @type {number} */ end;
  if (dontAddNull) {
    // stringToUTF8Array always appends null. If we don't want to do that, remember the
    // character that existed at the location where the null will be placed, and restore
    // that after the write (below).
    end = buffer + lengthBytesUTF8(string);
    lastChar = HEAP8[end];
  }
  stringToUTF8(string, buffer, Infinity);
  if (dontAddNull) HEAP8[end] = lastChar; // Restore the value under the null character.
}

function writeArrayToMemory(array, buffer) {
  HEAP8.set(array, buffer);
}

/** @param {boolean=} dontAddNull */
function writeAsciiToMemory(str, buffer, dontAddNull) {
  for (var i = 0; i < str.length; ++i) {
    HEAP8[((buffer++)>>0)] = str.charCodeAt(i);
  }
  // Null-terminate the pointer to the HEAP.
  if (!dontAddNull) HEAP8[((buffer)>>0)] = 0;
}

// end include: runtime_strings_extra.js
// Memory management

var HEAP,
/** @type {!ArrayBuffer} */
  buffer,
/** @type {!Int8Array} */
  HEAP8,
/** @type {!Uint8Array} */
  HEAPU8,
/** @type {!Int16Array} */
  HEAP16,
/** @type {!Uint16Array} */
  HEAPU16,
/** @type {!Int32Array} */
  HEAP32,
/** @type {!Uint32Array} */
  HEAPU32,
/** @type {!Float32Array} */
  HEAPF32,
/** @type {!Float64Array} */
  HEAPF64;

function updateGlobalBufferAndViews(buf) {
  buffer = buf;
  Module['HEAP8'] = HEAP8 = new Int8Array(buf);
  Module['HEAP16'] = HEAP16 = new Int16Array(buf);
  Module['HEAP32'] = HEAP32 = new Int32Array(buf);
  Module['HEAPU8'] = HEAPU8 = new Uint8Array(buf);
  Module['HEAPU16'] = HEAPU16 = new Uint16Array(buf);
  Module['HEAPU32'] = HEAPU32 = new Uint32Array(buf);
  Module['HEAPF32'] = HEAPF32 = new Float32Array(buf);
  Module['HEAPF64'] = HEAPF64 = new Float64Array(buf);
}

var TOTAL_STACK = 5242880;

var INITIAL_MEMORY = Module['INITIAL_MEMORY'] || 16777216;

// include: runtime_init_table.js
// In regular non-RELOCATABLE mode the table is exported
// from the wasm module and this will be assigned once
// the exports are available.
var wasmTable;

// end include: runtime_init_table.js
// include: runtime_stack_check.js


// end include: runtime_stack_check.js
// include: runtime_assertions.js


// end include: runtime_assertions.js
var __ATPRERUN__  = []; // functions called before the runtime is initialized
var __ATINIT__    = []; // functions called during startup
var __ATEXIT__    = []; // functions called during shutdown
var __ATPOSTRUN__ = []; // functions called after the main() is called

var runtimeInitialized = false;
var runtimeExited = false;
var runtimeKeepaliveCounter = 0;

function keepRuntimeAlive() {
  return noExitRuntime || runtimeKeepaliveCounter > 0;
}

function preRun() {

  if (Module['preRun']) {
    if (typeof Module['preRun'] == 'function') Module['preRun'] = [Module['preRun']];
    while (Module['preRun'].length) {
      addOnPreRun(Module['preRun'].shift());
    }
  }

  callRuntimeCallbacks(__ATPRERUN__);
}

function initRuntime() {
  runtimeInitialized = true;

  
  callRuntimeCallbacks(__ATINIT__);
}

function exitRuntime() {
  runtimeExited = true;
}

function postRun() {

  if (Module['postRun']) {
    if (typeof Module['postRun'] == 'function') Module['postRun'] = [Module['postRun']];
    while (Module['postRun'].length) {
      addOnPostRun(Module['postRun'].shift());
    }
  }

  callRuntimeCallbacks(__ATPOSTRUN__);
}

function addOnPreRun(cb) {
  __ATPRERUN__.unshift(cb);
}

function addOnInit(cb) {
  __ATINIT__.unshift(cb);
}

function addOnExit(cb) {
}

function addOnPostRun(cb) {
  __ATPOSTRUN__.unshift(cb);
}

// include: runtime_math.js


// https://developer.mozilla.org/en-US/docs/Web/JavaScript/Reference/Global_Objects/Math/imul

// https://developer.mozilla.org/en-US/docs/Web/JavaScript/Reference/Global_Objects/Math/fround

// https://developer.mozilla.org/en-US/docs/Web/JavaScript/Reference/Global_Objects/Math/clz32

// https://developer.mozilla.org/en-US/docs/Web/JavaScript/Reference/Global_Objects/Math/trunc

// end include: runtime_math.js
// A counter of dependencies for calling run(). If we need to
// do asynchronous work before running, increment this and
// decrement it. Incrementing must happen in a place like
// Module.preRun (used by emcc to add file preloading).
// Note that you can add dependencies in preRun, even though
// it happens right before run - run will be postponed until
// the dependencies are met.
var runDependencies = 0;
var runDependencyWatcher = null;
var dependenciesFulfilled = null; // overridden to take different actions when all run dependencies are fulfilled

function getUniqueRunDependency(id) {
  return id;
}

function addRunDependency(id) {
  runDependencies++;

  if (Module['monitorRunDependencies']) {
    Module['monitorRunDependencies'](runDependencies);
  }

}

function removeRunDependency(id) {
  runDependencies--;

  if (Module['monitorRunDependencies']) {
    Module['monitorRunDependencies'](runDependencies);
  }

  if (runDependencies == 0) {
    if (runDependencyWatcher !== null) {
      clearInterval(runDependencyWatcher);
      runDependencyWatcher = null;
    }
    if (dependenciesFulfilled) {
      var callback = dependenciesFulfilled;
      dependenciesFulfilled = null;
      callback(); // can add another dependenciesFulfilled
    }
  }
}

Module["preloadedImages"] = {}; // maps url to image data
Module["preloadedAudios"] = {}; // maps url to audio data

/** @param {string|number=} what */
function abort(what) {
  {
    if (Module['onAbort']) {
      Module['onAbort'](what);
    }
  }

  what = 'Aborted(' + what + ')';
  // TODO(sbc): Should we remove printing and leave it up to whoever
  // catches the exception?
  err(what);

  ABORT = true;
  EXITSTATUS = 1;

  what += '. Build with -s ASSERTIONS=1 for more info.';

  // Use a wasm runtime error, because a JS error might be seen as a foreign
  // exception, which means we'd run destructors on it. We need the error to
  // simply make the program stop.

  // Suppress closure compiler warning here. Closure compiler's builtin extern
  // defintion for WebAssembly.RuntimeError claims it takes no arguments even
  // though it can.
  // TODO(https://github.com/google/closure-compiler/pull/3913): Remove if/when upstream closure gets fixed.

  /** @suppress {checkTypes} */
  var e = new WebAssembly.RuntimeError(what);

  readyPromiseReject(e);
  // Throw the error whether or not MODULARIZE is set because abort is used
  // in code paths apart from instantiation where an exception is expected
  // to be thrown when abort is called.
  throw e;
}

// {{MEM_INITIALIZER}}

// include: memoryprofiler.js


// end include: memoryprofiler.js
// include: URIUtils.js


// Prefix of data URIs emitted by SINGLE_FILE and related options.
var dataURIPrefix = 'data:application/octet-stream;base64,';

// Indicates whether filename is a base64 data URI.
function isDataURI(filename) {
  // Prefix of data URIs emitted by SINGLE_FILE and related options.
  return filename.startsWith(dataURIPrefix);
}

// Indicates whether filename is delivered via file protocol (as opposed to http/https)
function isFileURI(filename) {
  return filename.startsWith('file://');
}

// end include: URIUtils.js
var wasmBinaryFile;
  wasmBinaryFile = 'data:application/octet-stream;base64,AGFzbQEAAAAB14KAgAAxYAN/f38AYAJ/fwBgAn9/AX9gAX8Bf2ABfwBgA39/fwF/YAJ/fABgBH9/f38Bf2ABfwF8YAABf2AFf39/f38AYAV/f39/fwF/YAF8AXxgBH9/f38AYAAAYAJ8fAF8YAV/f398fwBgA39+fwF+YAN/f3wBfGAEf398fABgBH9/f3wBf2ACfH8BfGAGf3x/f39/AX9gAn5/AX9gBH9+fn8AYAp/f3x8f3x/f39/AGAEf39/fABgB39/f39/f38AYAR8fHx/AXxgBXx/f398AXxgA3x8fAF8YAR/fHx8AGAHf39/f3x/fwBgA39/fwF8YAN/fHwBf2ACfHwBf2AFf39/f3wBf2ADf3x/AX9gAnx/AX9gA3x8fwF8YAJ/fAF8YAF+AX9gA3x+fgF8YAd/f39/f39/AX9gA35/fwF/YAF8AX5gAn5+AXxgBH9/fn8BfmAEf35/fwF/Ar2BgIAABwNlbnYFYWJvcnQADgNlbnYVZW1zY3JpcHRlbl9tZW1jcHlfYmlnAAUWd2FzaV9zbmFwc2hvdF9wcmV2aWV3MQhmZF9jbG9zZQADFndhc2lfc25hcHNob3RfcHJldmlldzEIZmRfd3JpdGUABwNlbnYWZW1zY3JpcHRlbl9yZXNpemVfaGVhcAADA2VudgtzZXRUZW1wUmV0MAAEFndhc2lfc25hcHNob3RfcHJldmlldzEHZmRfc2VlawALA4WCgIAAgwIOGQIaGxwPEh0SAB4EBQAfBgQDBAEDAQECAgECAwUFBAABBQACDQcBAAEEAAACAQogACIGEwYGIwkBBAQDAwEBAQEBAQUBAQgIBggKAAAAAAAADQAAAAAACgoEDQYICwEBBgYGCAQCAwsFBQAABwMGBgYIJBQEAAAQBQcHBAEGAQEAJRQAABAAABAAAwECAgkEAQQBAQYGAwICAgIBAQEBBAEGAQEEAQQDAQcCAgEGBAcNAQ8LJicMBSgMCAgMDAUDBAMCAgICAwMEAgwPKSoFCQkJDhUMAwMFEREDBQIJFQULKwADDSwXFwoFFgEtBQMFAgMEAgIBAgkDGBguCQQDLwswBIWAgIAAAXABQUEFh4CAgAABAYACgIACBomAgIAAAX8BQcD3wAILB6aBgIAACwZtZW1vcnkCABFfX3dhc21fY2FsbF9jdG9ycwAHCG11bmtfcnVuAAgEZnJlZQD6ARlfX2luZGlyZWN0X2Z1bmN0aW9uX3RhYmxlAQAQX19lcnJub19sb2NhdGlvbgDlAQZtYWxsb2MA+QEJc3RhY2tTYXZlAIQCDHN0YWNrUmVzdG9yZQCFAgpzdGFja0FsbG9jAIYCDGR5bkNhbGxfamlqaQCIAgnegICAAAEAQQELQCD6ASgrLTUmIycpKi8xMzI2Nzo7V1tcU1RVVlpdXmhpamt2d3h5fXx+f4sBjAGNAY4BjwGQAYQBkwGUAZUBmAGiAZEBsgG0AbEBswG5Ad4B3wHhAfIB8wEKz4qFgACDAgUAENoBC90XAg5/A3wjAEHgAmsiCiQAEJYBIQsgCkEANgKEAiAKQgA3AvwBIAogCzYC+AEgACsDICEYIAogAzkDmAIgCkIANwKMAgJAAkAgGJlEAAAAAAAA4EFjRQ0AIBiqIQwMAQtBgICAgHghDAsgCiAMNgKIAiAAKwMAIRggCkHoAWpBCGoiDCAAKwMIIAOiIAOiOQMAIApB2AFqQQhqIAwpAwA3AwAgCiAYIAOiIAOiOQPoASAKIAopA+gBNwPYASALIApB2AFqEJsBIAooAvgBIgsgACsDEBCcASALIAArAxgQnQEgCigC+AEgBBCaASAKIAooAogCIgtBBBD+ATYC/AEgCiABQQQQ/gE2AoACIAogAUEEEP4BNgKEAiAAQcAAaiENAkAgC0EBSA0AIAooAogCIgtBASALQQFKGyEOQQAhDCAKKAL8ASEPIAooAvgBIRAgCisDmAIhGCANIQsDQAJAAkAgCysDAEQAAAAAAAAAAGENABA/IQQMAQsgCysDCCALKwMQED4hBAsgCysDGCEZIApBwAJqQQhqIhEgCysDIDkDACAKQcgBakEIaiARKQMANwMAIAogGTkDwAIgCiAKKQPAAjcDyAEgBCAKQcgBahBGIAQgCysDKBA9IAsrAzAhGSAKQbACakEIaiIRIBggCysDOKI5AwAgCkG4AWpBCGogESkDADcDACAKIBkgGKI5A7ACIAogCikDsAI3A7gBIAQgCkG4AWoQTSAEIAsrA0AgGKIQUCAPIAxBAnRqIBAgBBCgATYCACALQdgAaiELIAxBAWoiDCAORw0ACwsgCigCjAIhEiAKKAKQAiETAkAgDSAKKAKIAkHYAGxqIgwgACABQQN0aiIETw0AIAooAoACIRQgCigC+AEhDSAKKAKEAiEVIAooAvwBIRYgDCELA0AgCysDACEZIAsrAxAhGAJAAkAgCysDCCIamUQAAAAAAADgQWNFDQAgGqohEQwBC0GAgICAeCERCyAYRAAAAAAAAAAAYyEPAkACQCAZmUQAAAAAAADgQWNFDQAgGaohDgwBC0GAgICAeCEOCwJAAkAgD0UNACANEJ4BIRAMAQsCQAJAIBiZRAAAAAAAAOBBY0UNACAYqiEPDAELQYCAgIB4IQ8LIBYgD0ECdGooAgAhEAtBACEPAkAgDkECSg0AAkAgCysDGCIYRAAAAAAAAAAAY0UNACANEJ4BIQ8MAQsCQAJAIBiZRAAAAAAAAOBBY0UNACAYqiEPDAELQYCAgIB4IQ8LIBYgD0ECdGooAgAhDwsCQAJAIBFBBEgNACALKwMgIRggCiALKwMoOQPIAiAKIBg5A8ACDAELIApBwAJqQQhqQgA3AwAgCkIANwPAAgsCQAJAIBFBBkgNACALKwMwIRggCiALKwM4OQO4AiAKIBg5A7ACDAELIApBsAJqQQhqQgA3AwAgCkIANwOwAgsCQAJAAkACQAJAAkACQCAOQX9qDgcAAQIDBAYFBgsgCkEYakEIaiAKQcACakEIaikDADcDACAKQQhqQQhqIApBsAJqQQhqKQMANwMAIAogCikDwAI3AxggCiAKKQOwAjcDCCAQIA8gCkEYaiAKQQhqEHQiESAFEGMgFCASQQJ0aiANIBEQoQE2AgAgEkEBaiESDAULIAsrA0AhGCAKQaACakEIaiIRIAsrA0g5AwAgCkHIAGpBCGogCkHAAmpBCGopAwA3AwAgCkE4akEIaiAKQbACakEIaikDADcDACAKQShqQQhqIBEpAwA3AwAgCiAYOQOgAiAKIAopA8ACNwNIIAogCikDsAI3AzggCiAKKQOgAjcDKCAQIA8gCkHIAGogCkE4aiAKQShqEGUiESAFEGMgFCASQQJ0aiANIBEQoQE2AgAgEkEBaiESDAQLIAsrAyghGCAKQegAakEIaiAKQbACakEIaikDADcDACAKIAopA7ACNwNoIBAgGCAKQegAahCJASIOIAsrAxgQhQEgCkGgAmpBCGohDwJAAkAgCysDICIYRAAAAAAAAPBBYyAYRAAAAAAAAAAAZnFFDQAgGKshEQwBC0EAIRELIA8gETYCACAKQdgAakEIaiARNgIAIApBADYCoAIgCiARNgKkAiAKIAopA6ACNwNYIA4gCkHYAGoQhgEgFSATQQJ0aiANIA4QnwE2AgAgE0EBaiETDAMLIAsrA0AhGCAKQaACakEIaiIRIAsrA0g5AwAgCiAYOQOgAiALKwMoIRggCkGYAWpBCGogCkGwAmpBCGopAwA3AwAgCkGIAWpBCGogESkDADcDACAKIAopA7ACNwOYASAKIAopA6ACNwOIASAQIApBmAFqIApBiAFqIBgQigEiDiALKwMYEIUBIApB0AJqQQhqIQ8CQAJAIAsrAyAiGEQAAAAAAADwQWMgGEQAAAAAAAAAAGZxRQ0AIBirIREMAQtBACERCyAPIBE2AgAgCkH4AGpBCGogETYCACAKQQA2AtACIAogETYC1AIgCiAKKQPQAjcDeCAOIApB+ABqEIYBIBUgE0ECdGogDSAOEJ8BNgIAIBNBAWohEwwCCyALQRBqIQAgEUF9akECbSIXQRAQ/gEhEAJAIBFBBUgNACAXQQEgF0EBShshAUEAIREDQCARQQR0Ig4gAGoiD0EYaisDACEYIBAgDmoiDiAPQSBqKwMAOQMIIA4gGDkDACARQQFqIhEgAUcNAAsLAkACQCAAKwMAIhhEAAAAAAAAAABjRQ0AIA0QngEhEQwBCwJAAkAgGJlEAAAAAAAA4EFjRQ0AIBiqIREMAQtBgICAgHghEQsgFiARQQJ0aigCACERCyARIBcgEEQAAAAAAAAAABB7Ig4gCysDGBCFASAKQaACakEIaiEPAkACQCALKwMgIhhEAAAAAAAA8EFjIBhEAAAAAAAAAABmcUUNACAYqyERDAELQQAhEQsgDyARNgIAIApBqAFqQQhqIBE2AgAgCkEANgKgAiAKIBE2AqQCIAogCikDoAI3A6gBIA4gCkGoAWoQhgEgFSATQQJ0aiANIA4QnwE2AgAgEBD6ASATQQFqIRMMAQsCQAJAIAsrAxgiGJlEAAAAAAAA4EFjRQ0AIBiqIREMAQtBgICAgHghEQsgFCARQQJ0aigCAEQAAAAAAADwPxBjCwJAAkAgCysDCCIYmUQAAAAAAADgQWNFDQAgGKohEQwBC0GAgICAeCERCyARQQN0IAtqQRBqIgsgBEkNAAsLIAogEjYCjAIgCiATNgKQAiAKQfgBaiAJEAkhEQJAIAZBAUgNAEEAIQ4DQEEAIQsCQCAHQQBMDQADQCAKQfgBaiAMIAQgAhAKIAtBAWoiCyAHRw0ACwsgCkH4AWogERAJIREgDkEBaiIOIAZHDQALCwJAIAhFDQAgCigC+AEgCBCaASAKQfgBaiAMIAQgAhAKIApB+AFqIBEQCSELIAooAowCIgxBAUgNAEEAIQcgCigCgAIhEQNAAkACQCARIAdBAnRqIgQoAgAQdUUNACAEKAIAIgRBqAFqKwMAIQIgBCsDoAEhGAwBC0QAAAAAAAAAACECIAQoAgAQZCEYCyALIAIgA6M5AwggCyAYIAOjOQMAIAtBEGohCyAHQQFqIgcgDEcNAAsLAkAgCigCjAJBAUgNACAKKAKMAiILQQEgC0EBShshBEEAIQsgCigCgAIhDCAKKAL4ASERA0AgESAMIAtBAnRqIgcoAgAQpQEgBygCABBhIAtBAWoiCyAERw0ACwsCQCAKKAKQAkEBSA0AIAooApACIgtBASALQQFKGyEEQQAhCyAKKAKEAiEMIAooAvgBIREDQCARIAwgC0ECdGoiBygCABCjASAHKAIAEIMBIAtBAWoiCyAERw0ACwsCQCAKKAKIAkEBSA0AIAooAogCIgtBASALQQFKGyEEQQAhCyAKKAL8ASEMIAooAvgBIREDQCARIAwgC0ECdGoiBygCABCkASAHKAIAEEIgC0EBaiILIARHDQALCyAKKAL4ARCZASAKKAKAAhD6ASAKKAKEAhD6ASAKKAL8ARD6ASAKQeACaiQAC9MBAgN/AXwjAEHQAGsiAiQAAkAgACgCEEEBSA0AQQAhAwNAIAJBwABqIAAoAgQgA0ECdGooAgAiBBBFIAJBMGogBBBMIAIgAisDQDkDACACIAIrA0g5AwggAiAEEE45AxAgAiACKwMwIAArAyAiBaM5AxggAiACKwM4IAWjOQMgIAIgBBBPIAArAyCjOQMoQQAhBANAIAEgAiAEQQN0aisDADkDACABQQhqIQEgBEEBaiIEQQZHDQALIANBAWoiAyAAKAIQSA0ACwsgAkHQAGokACABC7gGAgV/B3wjAEHwAGsiBCQAAkAgASACTyIFDQAgASEGA0ACQCAGKwMARAAAAAAAABxAYg0AAkACQCAGKwMYIgmZRAAAAAAAAOBBY0UNACAJqiEHDAELQYCAgIB4IQcLIAAoAgggB0ECdGooAgAhCAJAAkAgBisDECIJmUQAAAAAAADgQWNFDQAgCaohBwwBC0GAgICAeCEHCyAEQeAAaiAAKAIEIAdBAnRqKAIAIgcQRSAEQdAAaiAHEEwgBCsDYCEJIAQrA1AhCiAEKwNoIQsgBCsDWCEMIAcQTiENIAcQTyEOIARBwABqQQhqIgcgBisDKCIPIA0gDiADoqAgBisDIKAiDRDcASIOoiALIAwgA6KgIgugOQMAIARBIGpBCGogBykDADcDACAEIA8gDRC+ASIMoiAJIAogA6KgIgmgOQNAIAQgBCkDQDcDICAIIARBIGoQZiAEQTBqQQhqIgcgDiAGKwMwIgqiIAugOQMAIARBEGpBCGogBykDADcDACAEIAogDKIgCaA5AzAgBCAEKQMwNwMQIAggBEEQahBnCwJAAkAgBisDCCIJmUQAAAAAAADgQWNFDQAgCaohBwwBC0GAgICAeCEHCyAHQQN0IAZqQRBqIgYgAkkNAAsLIAAoAgAgAxC1AQJAIAUNAANAAkAgASsDAEQAAAAAAAAYQGINAAJAAkAgASsDECIDmUQAAAAAAADgQWNFDQAgA6ohBgwBC0GAgICAeCEGCyAAKAIEIAZBAnRqKAIAIgYQTiEJIAErAxghCyAGEE8hCiAEQeAAaiAGEEwgBCsDYCEDIAkgC6AiCxDcASEJIARB0ABqQQhqIgcgBCsDaCIMIAsQvgEiCyAKIAErAyCiIAsgDKIgAyAJoqGgIgwgASsDKJqiIguioDkDACAEQQhqIAcpAwA3AwAgBCADIAsgCaKhOQNQIAQgBCkDUDcDACAGIAQQTSABKwMwIgNEAAAAAAAAAABhDQAgBiAKIAMgDKKhEFALAkACQCABKwMIIgOZRAAAAAAAAOBBY0UNACADqiEGDAELQYCAgIB4IQYLIAZBA3QgAWpBEGoiASACSQ0ACwsgBEHwAGokAAtyAQJ/IwBBIGsiByQAQQAoAthsIghBjSJBriIgAxtBABDGARogByAGNgIcIAggBSAGEPEBGkEKIAgQywEaIAcgADYCECAIQcEiIAdBEGoQxgEaIAcgAjYCBCAHIAE2AgAgCEHYIiAHEMYBGiAHQSBqJAALMAAgASABoiACIAKioEQAAAAAAADgP6IgAysDACIBIAGiIAMrAwgiASABoqCgIACiCykAIAAgAKIgASABoqEiAJogACAARAAAAAAAAAAAYxtEGC1EVPshCUCiCzsBAXwgAkQYLURU+yEJQKIgACsDACABKwMAoSIDIAOiIAArAwggASsDCKEiAyADoqCfIgMgA6CgIAKiC5MDAgl8A38CQAJAAkAgAUECRg0AAkAgAUEBTg0ARAAAAAAAAAAAIQVEAAAAAAAAAAAhBgwDCyADKwMIIQcgAysDACEIRAAAAAAAAAAAIQZBACEDRAAAAAAAAAAAIQkDQCAIIAJBACADQQFqIg4gDiABRiIPG0EEdGoiECsAAKAiBSAHIAIgA0EEdGoiAysACKAiCqIgCCADKwAAoCILIAcgECsACKAiDKKhIg0gBSAFoiAMIAyioCALIAuiIAogCqKgIAsgBaIgCiAMoqCgoKIgBqAhBiAJIA2gIQkgDiEDIA9FDQAMAgsACyACKwAQIgVEAAAAAAAA4D+iIAIrAAAiCkQAAAAAAADgP6KgIgsgC6IgAkEYaisAACILRAAAAAAAAOA/oiACKwAIIgxEAAAAAAAA4D+ioCIGIAaioCAFIAqhIgUgBaIgCyAMoSIFIAWioJ9EAAAAAAAAAACgIgUgBaJEAAAAAAAAAACgRAAAAAAAAChAo6AgAKIPCyAJRAAAAAAAABhAoiEFCyAGIACiIAWjC90BAgR/BnxBACEDRAAAAAAAAAAAIQdEAAAAAAAAAAAhCAJAIABBAEwNAEQAAAAAAAAAACEIRAAAAAAAAAAAIQcDQCAHIAEgA0EEdGoiBCsDACIJIAFBACADQQFqIgMgAyAARiIFG0EEdGoiBisDCCIKoiAGKwMAIgsgBCsDCCIMoqGgIQcgCCAJIAuhIgkgCaIgDCAKoSIJIAmioJ+gIQggAyEDIAVFDQALIAdEAAAAAAAA4D+iIQcLIAIgApogAiACRAAAAAAAAAAAYxtEGC1EVPshCUCiIAigoiAHoAvpAQIEfwh8QQAhA0QAAAAAAAAAACEHAkACQCABQQBKDQBEAAAAAAAAAAAhCEQAAAAAAAAAACEJDAELRAAAAAAAAAAAIQlEAAAAAAAAAAAhCANAIAcgAiADQQR0aiIEKwMAIgogAkEAIANBAWoiAyADIAFGIgUbQQR0aiIGKwMIIguiIAYrAwAiDCAEKwMIIg2ioSIOoCEHIAkgDSALoCAOoqAhCSAIIAogDKAgDqKgIQggAyEDIAVFDQALIAdEAAAAAAAACECiIQcLIAAgCUQAAAAAAADwPyAHoyIOojkDCCAAIAggDqI5AwALGgAgASABoiACIAKioCAAokQAAAAAAAAoQKML9QEBBn8gACgCNCEBIAAoAiwhAgJAAkAgAEE4aigCACIDRQ0AIANBNEE8IAMoAiwgAkYbaiABNgIADAELIAIoAtgBIABHDQAgAiABNgLYAQsgAEE8aiEEIABBNGohBQJAIAFFDQAgAUE0QTwgASgCLCACRhtqIAM2AgQLIABCADcCNCAFIAQgAiAAKAIwIgZGGyICKAIAIQECQAJAIAIoAgQiA0UNACADQTRBPCADKAIsIAZGG2ogATYCAAwBCyAGKALYASAARw0AIAYgATYC2AELAkAgAUUNACABQTRBPCABKAIsIAZGG2ogAzYCBAsgAkIANwIAC50BACAAQgA3A2AgAEIANwJEIABCADcDACAAIAE2AiQgAEHwAGpBADoAACAAQegAakIANwMAIABBCGpCADcDACAAQRBqQgA3AwAgAEEYakIANwMAIAEoAgghASAAIAI2AiggACABNgIsIAIoAgghAiAAQgA3AnQgACACNgIwIABCADcCNCAAQTxqQgA3AgAgAEEBOgB8IABBADYCICAAC7UGAgt/BHwjAEEQayIDJAAgASgCBCEEIAAgASgCACIFNgIkIAUoAgghBiAAIAQ2AiggACAGNgIsIAAgBCgCCDYCMAJAIAEoAiAiBkEBSA0AQQAhBwNAIAUoAggiCCsAOCEOIAEoAiQgB0HgAGxqIgYgBisACCAIQcAAaisAAKE5AwggBiAGKwAAIA6hOQMAIAQoAggiCEHAAGorAAAhDiAIKwA4IQ8gBkIANwM4IAYgBisAECAPoTkDECAGQcAAaiIJQgA3AwAgBkEYaiIIIAgrAAAgDqE5AwACQCAAKAJEIgpBAUgNACAGQThqIQsgBigCWCEMIAAoAkghDUEAIQYDQAJAIAwgDSAGQeAAbGoiCCgCWEcNACALIAgrAzg5AwAgCSAIKwNAOQMACyAGQQFqIgYgCkcNAAsLIAdBAWoiByABKAIgIgZIDQALCyABKAIkIQggACAGNgJEIAAgCDYCSCAAIAEpAxA3A1AgAEHYAGogAUEYaiIGKQMANwMAIAAgBSsDYCAEKwNgojkDACAAIAUrA2ggBCsDaKI5AwggAEEYaiAEQfgAaisAACAFQfgAaisAAKEiDiAGKwAAIg8gBCsAcCAFKwBwoSIQIAErABAiEaIgDiAPoqAiDqKhOQMAIAAgECARIA6ioTkDECABKAIAKAKEASEGIAMgASgCBCgChAEiCDYCDCADIAY2AgggACACKAKQASAIQeWW4uoFbCAGQeHj/bp8bCIKcyADQQhqEHEiDEHs8AAgDBs2AmAgA0F/NgIMIAMgBjYCCCAAIAIoApABIApBm+mdlXpzIANBCGoQcSIKQezwACAKGzYCaEHs8AAhCgJAIAYgCEYNACADIAY2AgwgAyAINgIIIAIoApABIAhB4eP9unxsIAZB5Zbi6gVscyADQQhqEHEiCkHs8AAgChshCgsgACAKNgJkIAMgCDYCCCADQX82AgwgACACKAKQASAIQeHj/bp8bEGb6Z2VenMgA0EIahBxIghB7PAAIAgbNgJsIAAgBiAAKAJgKAIAIghHIAhBf0dxOgBwAkAgACgCeEEDRw0AIABBAToAfCAAQQA2AngLIANBEGokAAuuAwIFfxB8AkAgACgCRCIEQQFIDQAgACgCMCIFQcAAaisAACAAKAIsIgZBwABqKwAAoSEJIAUrADggBisAOKEhCiAAQdgAaisDACELIAArA1AhDCAAKwMAIQ0gBSsDcCEOIAYrA3AhDyADmiEQIAUrAyAhESAFKwMQIRIgBisDICETIAYrAxAhFCAAKAJIIQdBACEIA0AgByAIQeAAbGoiAEIANwNIIABEAAAAAAAA8D8gEyAAKwAAIgMgDKIgCyAAKwAIIhWioCIWoiAWoiAUoCAAKwAQIhYgDKIgCyAAQRhqKwAAIheioCIYIBGiIBiiIBKgoKM5AyggAEQAAAAAAADwPyATIAMgC6IgDCAVoqEiGKIgGKIgFKAgFiALoiAMIBeioSIYIBGiIBiiIBKgoKM5AyAgACAKIBYgA6GgIAyiIAsgCSAXIBWhoKKgIAKgRAAAAAAAAAAApCAQoiABozkDUCAAIA0gBSsASCAXIA6ioSAGKwBIIBUgD6KhoSAMoiALIBYgDqIgBSsAUKAgAyAPoiAGKwBQoKGioKI5AzAgCEEBaiIIIARHDQALCwunAgILfAR/AkAgACgCeEUNACAAKAJEQQFIDQAgACsDUCECIAAoAjAhDSAAKAIsIQ4gAEHYAGorAwAiA5ohBEEAIQ8DQCAAKAJIIA9B4ABsaiIQKwAQIQUgEEEYaisAACEGIBArAAghByAQKwAAIQggDiAOKwBQIAIgECsDQCIJoiADIBArAzgiCqKgIAGiIgsgDisDECIMoqE5A1AgDiAOKwBIIAwgAiAKoiAJIASioCABoiIJoqE5A0ggDiAOKwMgIAkgB6IgCCALoqGiIA4rA3CgOQNwIA0gCyANKwMQIgeiIA0rAFCgOQNQIA0gCSAHoiANKwBIoDkDSCANIA0rAyAgBSALoiAJIAaioaIgDSsDcKA5A3AgD0EBaiIPIAAoAkRIDQALCwuJBgIVfAR/AkAgACgCREEBSA0AIABBGGorAwAhASAAKwMIIQIgACsDECEDIAArA1AhBCAAKAIwIRYgACgCLCEXIABB2ABqKwMAIgWaIQZBACEYA0AgFisASCEHIBcrAEghCCAWKwBQIQkgFisDcCEKIBcrAFAhCyAXKwNwIQwgACgCSCAYQeAAbGoiGSAZKwNIIg0gGSsDICIOIBkrA1AgFisAuAEgGUEYaisDACIPIBYrA8gBIhCioSAXKwC4ASAZKwMIIhEgFysDyAEiEqKhoSAEoiAFIBkrAxAiEyAQoiAWKwDAAaAgGSsDACIQIBKiIBcrAMABoKGioKGioCIURAAAAAAAAAAAIBREAAAAAAAAAABkGyIUOQNIIBkgGSsDOCIVIA4gGSsDMCADIAcgDyAKoqEgCCARIAyioaGgIgcgBKIgBSABIAkgEyAKoqAgCyAQIAyioKGgIgqioKCioSIMRAAAAAAAAAAAIAxEAAAAAAAAAABkGyIMOQM4IBkgGSsDQCIIIAcgBqIgBCAKoqAgGSsDKKKhIgcgAiAMoiIKmiIMIAcgDGQbIgwgCiAMIApjGzkDQCAXIBcrALgBIAQgFCANoSIMoiIKIBcrAxAiB6KhOQO4ASAXIBcrAMABIAcgBSAMoiIMoqE5A8ABIBcgEiAXKwMgIBEgCqIgECAMoqGioDkDyAEgFiAWKwMgIBMgDKIgCiAPoqGiIBYrA8gBoDkDyAEgFiAMIBYrAxAiEqIgFisAwAGgOQPAASAWIAogEqIgFisAuAGgOQO4ASAXIBcrAFAgFysDECISIAQgGSsDQCAIoSIMoiAFIBkrAzggFaEiB6KgIgqioTkDUCAXIBcrAEggEiAEIAeiIAwgBqKgIgyioTkDSCAXIBcrAyAgESAMoiAQIAqioaIgFysDcKA5A3AgFiAKIBYrAxAiEaIgFisAUKA5A1AgFiAMIBGiIBYrAEigOQNIIBYgFisDICATIAqiIAwgD6KhoiAWKwNwoDkDcCAYQQFqIhggACgCREgNAAsLCy4BAX9BAUEMEP4BIgEgAEEEIAAbIgA2AgQgAUEANgIAIAEgAEEEEP4BNgIIIAELHgACQCAARQ0AIAAoAggQ+gEgAEEANgIIIAAQ+gELC1kBAX8CQCAAKAIAIAAoAgQiAkcNACAAIAJBA2xBA2pBAm0iAjYCBCAAIAAoAgggAkECdBD7ATYCCAsgACgCCCAAKAIAIgJBAnRqIAE2AgAgACACQQFqNgIACy4BAX8gACAAKAIAQX9qIgE2AgAgACgCCCABQQJ0aiIAKAIAIQEgAEEANgIAIAELcAEEfwJAIAAoAgAiAkEBSA0AIAAoAgghA0EAIQQCQANAIAMgBEECdGoiBSgCACABRg0BIARBAWoiBCACRg0CDAALAAsgACACQX9qIgQ2AgAgBSADIARBAnQiBGooAgA2AgAgACgCCCAEakEANgIACws6AQF/AkAgACgCAEEBSA0AQQAhAgNAIAAoAgggAkECdGooAgAgAREEACACQQFqIgIgACgCAEgNAAsLC1wBBH8gACgCACICQQBKIQNBASEEAkAgAkEBSA0AIAAoAggiBSgCACABRg0AAkADQCAEIgAgAkYNASAAQQFqIQQgBSAAQQJ0aigCACABRw0ACwsgACACSCEDCyADCwoAIAEoAgAgAEYLGAACQCAAKAIAQcDwAEcNACAAIAE2AhALC0wBAX9BAUEsEP4BIgJBwPAAIAAgARC3ARogAkEANgIQQQBBARBtIQAgAkIANwIYIAIgADYCFEEAEBkhACACQQA2AiggAiAANgIkIAILCQAgACgCFBBuC6YCAgR/CHwCQAJAIAAoAhwiA0UNACADKAIoIQQMAQtBAUGAgAIQ/gEhAyAAKAIkIAMQGyAAKAIcIQVBASEGA0AgAyAGQThsaiIEIAU2AiggBCEFIAZBAWoiBkHJBEcNAAsLIAAgBDYCHCADQQA2AgAgAUEQaisAACEHIAJBEGorAAAhCCABQRhqKwAAIQkgAkEYaisAACEKIAFBIGorAAAhCyACQSBqKwAAIQwgASsACCENIAIrAAghDiADIAE2AiwgA0EANgIoIANBIGogCyAMIAsgDGQbOQMAIANBGGogCSAKIAkgCmQbOQMAIANBEGogByAIIAcgCGMbOQMAIAMgDSAOIA0gDmMbOQMIIAEgAzYCKCADQTBqIAI2AgAgAiADNgIoIAML8gQCBH8OfAJAAkAgAEUNACAAKAIADQEgACEDAkAgACgCAA0AIAFBIGorAAAhByABQRhqKwAAIQggAUEQaisAACEJIAErAAghCiAAIQMDQCADQSxqIQQCQCADQTBqIgUoAgAiBkEYaisAACILIAYrAAgiDKEgBkEgaisAACINIAZBEGorAAAiDqGiIAMoAiwiBkEYaisAACIPIAggDyAIZBsgBisACCIQIAogECAKYxuhIAZBIGorAAAiESAHIBEgB2QbIAZBEGorAAAiEiAJIBIgCWMboaKgIhMgCyAIIAsgCGQbIAwgCiAMIApjG6EgDSAHIA0gB2QbIA4gCSAOIAljG6GiIA8gEKEgESASoaKgIhRiDQAgDCALoCAKoSAIoSILmiALIAtEAAAAAAAAAABjGyAOIA2gIAmhIAehIguaIAsgC0QAAAAAAAAAAGMboCEUIBAgD6AgCqEgCKEiC5ogCyALRAAAAAAAAAAAYxsgEiARoCAJoSAHoSILmiALIAtEAAAAAAAAAABjG6AhEwsgBSAEIBQgE2MbKAIAIgMoAgBFDQALCyADKAIoIQYgAiABIAMQJCEEIAZBLEEwIAYoAiwgA0YbaiAENgIAIAQgBjYCKAJAIAZFDQADQCABKwAQIQcgASsAGCEIIAErACAhCSAGIAYrAAgiCiABKwAIIgsgCiALYxs5AwggBkEgaiIDIAMrAAAiCiAJIAogCWQbOQMAIAZBGGoiAyADKwAAIgkgCCAJIAhkGzkDACAGQRBqIgMgAysAACIIIAcgCCAHYxs5AwAgBigCKCIGDQALCyAAIQELIAEPCyACIAEgABAkCyUBAX8gACgCFBBsAkAgACgCJCIBRQ0AIAFBAhAeCyAAKAIkEBoLMAEBfyMAQRBrIgMkACADIAI2AgwgAyABNgIIIAAoAhRBAyADQQhqEHIgA0EQaiQACxQAIAAoAgAgASgCBCABKAIAEQEACxAAIAAoAhQgAiABEHFBAEcL0AIBA38jAEEQayIDJAAgACgCFCACIAFBBCAAEG8hAiAAIAAoAhggAiAAECU2AhgCQAJAIAAoAgwiAQ0AQQAhAQwBCyABQQAgASgCAEHA8ABGGyEBCyACIAEgACABGygCKDYCLAJAAkAgACgCDCIBRQ0AQQAhBAJAIAEoAgAiBUHA8ABHDQAgAUEYaigCACEECyAERQ0BIANCADcCBCADQQA2AgwgAyABQQAgBUHA8ABGGzYCACAEIAJBASADECwMAQtBACEBAkAgACgCCCIERQ0AQQAhASAEKAIAQcDwAEcNACAEQRhqKAIAIQELIANBADYCDCADQQU2AgggAyABNgIEIAMgADYCACACIAMQLgsCQAJAIAAoAgwiAg0AQQAhAgwBCyACQQAgAigCAEHA8ABGGyECCyACIAAgAhsiACAAKAIoQQFqNgIoIANBEGokAAu0AwIFfwZ8IwBB0ABrIgIkACACIAAgASgCBBEBAAJAAkAgASgCHCIDRQ0AIAMoAighBAwBC0EBQYCAAhD+ASEDIAEoAiQgAxAbIAEoAhwhBUEBIQYDQCADIAZBOGxqIgQgBTYCKCAEIQUgBkEBaiIGQckERw0ACwsgASAENgIcIAMgADYCACACQTBqIAAgASgCBBEBAAJAAkAgASgCECIGRQ0AIAIrAzAhByACKwNAIQggAisDOCEJIAIrA0ghCiACQSBqIAAgBhEBACAKIAmhRAAAAKCZmbk/oiILIAIrAyhEAAAAoJmZuT+iIgkgCyAJZBsgAisDSKAhCiAIIAehRAAAAKCZmbk/oiIMIAIrAyBEAAAAoJmZuT+iIgcgDCAHZBsgAisDQKAhCCACKwM4IAuaIgsgCSAJIAtkG6AhCSACKwMwIAyaIgsgByAHIAtkG6AhBwwBCyACKwNIIQogAisDQCEIIAIrAzghCSACKwMwIQcLIANBMGpBADYCACADQgA3AyggA0EgaiAKOQMAIANBGGogCDkDACADQRBqIAk5AwAgAyAHOQMIIAJB0ABqJAAgAwvLAwEGfyMAQYACayIEJAAgBCAANgIAQcAAIQUgBCEGQQEhBwNAAkACQCABKwAIIAYgB0F/aiIIQQJ0IglqKAIAIgBBGGorAABlDQAgCCEHDAELAkAgACsACCABKwAYZQ0AIAghBwwBCwJAIAErABAgAEEgaisAAGUNACAIIQcMAQsCQCAAQRBqKwAAIAErACBlDQAgCCEHDAELAkAgACgCAEUNAAJAIAJFDQAgASAAIAMoAgAQOCAIIQcMAgsCQCAAKAIsIAEoAixPDQAgACABIAMoAgAQOAsgASgCACAAKAIAQQAgAygCDCADKAIIEQcAGiAIIQcMAQsCQAJAIAcgBUoNACAFIQgMAQsgBUEBdCEIAkAgBiAERw0AIAhBBBD+ASIGIAQgBUECdBC/ARoMAQsgBiAFQQN0EPsBIQYLIAYgCWogAEEwaigCADYCAAJAAkAgByAITg0AIAghBQwBCyAIQQF0IQUCQCAGIARHDQAgBUEEEP4BIgYgBCAIQQJ0EL8BGgwBCyAGIAhBA3QQ+wEhBgsgBiAHQQJ0aiAAKAIsNgIAIAdBAWohBwsgB0EASg0ACwJAIAYgBEYNACAGEPoBCyAEQYACaiQACwQAIAILoAIBBH8gACgCLCECAkACQCABKAIAIgMoAgwiBA0AQQAhBAwBCyAEQQAgBCgCAEHA8ABGGyEECwJAAkAgAiAEIAMgBBsoAihHDQACQCABKAIEIgRFDQAgBCAAQQAgARAsCyAAKAIoIgJFDQEgAEEoaiEDIAAhBANAAkACQCAEIAIoAiwiBUcNACACQTBqKAIAIABBASABECwMAQsgBSAAQQAgARAsCyADKAIAIgRBKGohAyAEKAIoIgINAAwCCwALIABBMGooAgAiBEUNAANAAkACQCAEQRBqKAIAIABHDQAgBCAEKAIEKAIAIAAoAgAgBCgCGCABKAIMIAEoAggRBwA2AhggBEEUaiEEDAELIARBCGohBAsgBCgCACIEDQALCwuxAwIEfwh8AkACQCAAKAIUIAIgARBwIgMgACgCGCIERw0AQQAhAgwBCwJAIAMoAigiASAERw0AAkAgBCgCLCICIANHDQAgBEEwaigCACECCyACIAQoAig2AiggBCAAKAIcNgIoIAAgBDYCHAwBCyABKAIoIQICQCABKAIsIgUgA0cNACABQTBqKAIAIQULAkACQCACKAIsIgYgAUcNACACQSxqIQEgBiAAKAIcNgIoIAAgBjYCHAwBCyACQTBqIgEoAgAiBiAAKAIcNgIoIAAgBjYCHAsgASAFNgIAIAUgAjYCKAJAIAJFDQADQCACKAIsIgFBEGorAAAhByACQTBqKAIAIgVBEGorAAAhCCABQRhqKwAAIQkgBUEYaisAACEKIAFBIGorAAAhCyAFQSBqKwAAIQwgAiABKwAIIg0gBSsACCIOIA0gDmMbOQMIIAJBIGogCyAMIAsgDGQbOQMAIAJBGGogCSAKIAkgCmQbOQMAIAJBEGogByAIIAcgCGMbOQMAIAIoAigiAg0ACwsgBCECCyAAIAI2AhggAyAAEDAgAyAAKAIcNgIoIAAgAzYCHAvkAgEFfyAAQTBqIgIoAgAhAyACQQA2AgACQCADRQ0AA0ACQAJAAkAgAyICKAIEIgQgAEcNACACQRBqKAAAIQQgAigADCEFIAIoAgghAwJAIAJBFGooAAAiBkUNACAGQQBBDCAGKAIEIARGG2ogBTYCAAsCQAJAIAVFDQACQCAFKAIEIARHDQAgBUEIaiEFDAILIAVBFGohBQwBCyAEQTBqIQULIAUgBjYCACABKAIMIgUNAUEAIQUMAgsgAkEUaigCACEDIAIoAAAhBQJAIAIoAAgiBkUNACAGQQBBDCAGKAIEIARGG2ogBTYCAAsCQAJAIAVFDQACQCAFKAIEIARHDQAgBUEIaiEFDAILIAVBFGohBQwBCyAEQTBqIQULIAUgBjYCACABKAIMIgUNAEEAIQUMAQsgBUEAIAUoAgBBwPAARhshBQsgAiAFIAEgBRsiBSgCIDYCCCAFIAI2AiAgAw0ACwsLCgAgAEEFQQAQMgvlAwEJfyMAQZACayIDJAACQCAAKAIYRQ0AIAAoAhRBBiAAEHJBACEEAkAgACgCCCIFRQ0AQQAhBCAFKAIAQcDwAEcNACAFQRhqKAIAIQQLIAMgAjYCDCADIAE2AgggAyAENgIEIAMgADYCACADIAAoAhg2AhBBwAAhBiADQRBqIQdBASEIA0ACQAJAIAcgCEF/aiIJQQJ0IgpqKAIAIgsoAgBFDQAgCyADEC4gCSEIDAELAkACQCAIIAZKDQAgBiEJDAELIAZBAXQhCQJAIAcgA0EQakcNACAJQQQQ/gEiByADQRBqIAZBAnQQvwEaDAELIAcgBkEDdBD7ASEHCyAHIApqIAtBMGooAgA2AgACQAJAIAggCU4NACAJIQYMAQsgCUEBdCEGAkAgByADQRBqRw0AIAZBBBD+ASIHIANBEGogCUECdBC/ARoMAQsgByAJQQN0EPsBIQcLIAcgCEECdGogCygCLDYCACAIQQFqIQgLIAhBAEoNAAsCQCAHIANBEGpGDQAgBxD6AQsCQCAFRQ0AIAQNACAAIAUgASACELgBCwJAAkAgACgCDCIIDQBBACEIDAELIAhBACAIKAIAQcDwAEYbIQgLIAggACAIGyIIIAgoAihBAWo2AigLIANBkAJqJAALlgIBA38jAEEQayIDJAACQCAAKAIUIAIgARBxIgJFDQACQCACIAAQNEUNAAJAIAAoAgwiAUUNAEEAIQQCQCABKAIAIgVBwPAARw0AIAFBGGooAgAhBAsgBEUNASADQgA3AgQgA0EANgIMIAMgAUEAIAVBwPAARhs2AgAgBCACQQEgAxAsDAELQQAhAQJAIAAoAggiBEUNAEEAIQEgBCgCAEHA8ABHDQAgBEEYaigCACEBCyADQQA2AgwgA0EFNgIIIAMgATYCBCADIAA2AgAgAiADEC4LAkACQCAAKAIMIgINAEEAIQIMAQsgAkEAIAIoAgBBwPAARhshAgsgAiAAIAIbIgAgACgCKEEBajYCKAsgA0EQaiQAC8cGAgd/CHwjAEHQAGsiAiQAIAEoAhghAyACIAAoAgAgASgCBBEBAAJAAkAgACsACCACKwMAZUUNACAAQRhqKwAAIAIrAxBmRQ0AIABBEGorAAAgAisDCGVFDQBBACEEIAArACAgAisDGGYNAQsgAkEwaiAAKAIAIgQgASgCBBEBAAJAAkAgASgCECIFRQ0AIAIrAzAhCSACKwNAIQogAisDOCELIAIrA0ghDCACQSBqIAQgBREBACAMIAuhRAAAAKCZmbk/oiINIAIrAyhEAAAAoJmZuT+iIgsgDSALZBsgAisDSKAhDCAKIAmhRAAAAKCZmbk/oiIOIAIrAyBEAAAAoJmZuT+iIgkgDiAJZBsgAisDQKAhCiACKwM4IA2aIg0gCyALIA1kG6AhCyACKwMwIA6aIg0gCSAJIA1kG6AhCQwBCyACKwNIIQwgAisDQCEKIAIrAzghCyACKwMwIQkLIAAgDDkDICAAIAo5AxggACALOQMQIAAgCTkDCEEAIQZBACEEAkAgAyAARg0AAkAgACgCKCIFIANHDQACQCADKAIsIgQgAEcNACADQTBqKAIAIQQLIAQgAygCKDYCKCADIAEoAhw2AiggASADNgIcDAELIAUoAighBAJAIAUoAiwiByAARw0AIAVBMGooAgAhBwsCQAJAIAQoAiwiCCAFRw0AIARBLGohBSAIIAEoAhw2AiggASAINgIcDAELIARBMGoiBSgCACIIIAEoAhw2AiggASAINgIcCyAFIAc2AgAgByAENgIoAkAgBEUNAANAIAQoAiwiBUEQaisAACELIARBMGooAgAiB0EQaisAACEJIAVBGGorAAAhDCAHQRhqKwAAIQogBUEgaisAACENIAdBIGorAAAhDiAEIAUrAAgiDyAHKwAIIhAgDyAQYxs5AwggBEEgaiANIA4gDSAOZBs5AwAgBEEYaiAMIAogDCAKZBs5AwAgBEEQaiALIAkgCyAJYxs5AwAgBCgCKCIEDQALCyADIQQLIAEgBCAAIAEQJTYCGCAAIAEQMAJAIAEoAgwiBEUNACAEQQAgBCgCAEHA8ABGGyEGCyAAIAYgASAGGygCKDYCLEEBIQQLIAJB0ABqJAAgBAsJACAAIAEQNBoLqQMCBn8EfCMAQYACayIFJAACQCAAKAIYIgBFDQAgAisDGCELIAIrAxAhDCACKwMIIQ0gAisDACEOIAUgADYCAEHAACEGIAUhB0EBIQADQAJAAkAgByAAQX9qIghBAnQiCWooAgAiAisACCAMZQ0AIAghAAwBCwJAIA4gAkEYaisAAGUNACAIIQAMAQsCQCACQRBqKwAAIAtlDQAgCCEADAELAkAgDSACQSBqKwAAZQ0AIAghAAwBCwJAIAIoAgAiCkUNACABIApBACAEIAMRBwAaIAghAAwBCwJAAkAgACAGSg0AIAYhCAwBCyAGQQF0IQgCQCAHIAVHDQAgCEEEEP4BIgcgBSAGQQJ0EL8BGgwBCyAHIAZBA3QQ+wEhBwsgByAJaiACQTBqKAIANgIAAkACQCAAIAhODQAgCCEGDAELIAhBAXQhBgJAIAcgBUcNACAGQQQQ/gEiByAFIAhBAnQQvwEaDAELIAcgCEEDdBD7ASEHCyAHIABBAnRqIAIoAiw2AgAgAEEBaiEACyAAQQBKDQALIAcgBUYNACAHEPoBCyAFQYACaiQAC6IKAgZ/CnwjAEGAAmsiByQAAkAgACgCGCIARQ0AIAIrAwAhDSADKwMAIQ4gAisDCCEPIAMrAwghECAHIAA2AgAgECAPoSERIA4gDaEhEkHAACEIIAchAEEBIQIDQAJAAkAgACACQX9qIglBAnQiCmooAgAiAygCACILRQ0AIAQgASALIAYgBREhACIOIAQgDmMbIQQgCSECDAELIAMoAiwiC0EgaisAACETIAtBGGorAAAhFCALQRBqKwAAIRUgCysACCEQAkACQAJAIBJEAAAAAAAAAABiIgwNAEQAAAAAAADwfyEOIA0gEGMNAkQAAAAAAADw/yEQIBQgDWNFDQEMAgsgECANoSASoyIQIBQgDaEgEqMiFCAQIBRkGyEOIBAgFCAQIBRjGyEQCwJAAkAgEUQAAAAAAAAAAGINAAJAIA8gFWNFDQBEAAAAAAAA8H8hDgwDCyAOIRREAAAAAAAA8H8hDiATIA9jRQ0BDAILIA4gFSAPoSARoyIVIBMgD6EgEaMiEyAVIBNkGyIUIA4gFGMbIRQgECAVIBMgFSATYxsiDiAQIA5kGyEQC0QAAAAAAADwfyEOIBBEAAAAAAAA8D9lRQ0AIBREAAAAAAAAAABmRQ0AIBAgFGVFDQAgEEQAAAAAAAAAACAQRAAAAAAAAAAAZBshDgsgA0EwaigCACILKwAIIRQgC0EgaisAACEWIAtBGGorAAAhFSALQRBqKwAAIRMCQAJAAkAgDA0ARAAAAAAAAPB/IRAgDSAUYw0CRAAAAAAAAPD/IRQgFSANY0UNAQwCCyAUIA2hIBKjIhQgFSANoSASoyIVIBQgFWQbIRAgFCAVIBQgFWMbIRQLAkACQCARRAAAAAAAAAAAYg0AAkAgDyATY0UNAEQAAAAAAADwfyEQDAMLIBAhFUQAAAAAAADwfyEQIBYgD2NFDQEMAgsgECATIA+hIBGjIhMgFiAPoSARoyIWIBMgFmQbIhUgECAVYxshFSAUIBMgFiATIBZjGyIQIBQgEGQbIRQLRAAAAAAAAPB/IRAgFEQAAAAAAADwP2VFDQAgFUQAAAAAAAAAAGZFDQAgFCAVZUUNACAURAAAAAAAAAAAIBREAAAAAAAAAABkGyEQCwJAAkAgDiAQY0UNAAJAAkAgECAEYw0AIAghCyAJIQIMAQsCQAJAIAIgCEoNACAIIQsMAQsgCEEBdCELAkAgACAHRw0AIAtBBBD+ASIAIAcgCEECdBC/ARoMAQsgACAIQQN0EPsBIQALIAAgCmogAygCMDYCAAsCQCAOIARjDQAgCyEIDAMLAkACQCACIAtODQAgCyEIDAELIAtBAXQhCAJAIAAgB0cNACAIQQQQ/gEiACAHIAtBAnQQvwEaDAELIAAgC0EDdBD7ASEACyAAIAJBAnRqIAMoAiw2AgAMAQsCQAJAIA4gBGMNACAIIQsgCSECDAELAkACQCACIAhKDQAgCCELDAELIAhBAXQhCwJAIAAgB0cNACALQQQQ/gEiACAHIAhBAnQQvwEaDAELIAAgCEEDdBD7ASEACyAAIApqIAMoAiw2AgALAkAgECAEYw0AIAshCAwCCwJAAkAgAiALTg0AIAshCAwBCyALQQF0IQgCQCAAIAdHDQAgCEEEEP4BIgAgByALQQJ0EL8BGgwBCyAAIAtBA3QQ+wEhAAsgACACQQJ0aiADKAIwNgIACyACQQFqIQILIAJBAEoNAAsgACAHRg0AIAAQ+gELIAdBgAJqJAAL1gIBB38gAUEwaiEDIABBMGohBAJAAkAgAigCDCIFDQBBACEFDAELIAVBACAFKAIAQcDwAEYbIQULIAMoAgAhBiAEKAIAIQcCQAJAIAUgAiAFGyIIKAIgIglFDQAgCCAJKAIINgIgDAELQQFBgIACEP4BIQkgCCgCJCAJEBsgCCgCDCEEQQEhBQNAIAkgBUEcbGohA0EAIQICQCAERQ0AIARBACAEKAIAQcDwAEYbIQILIAMgAiAIIAIbIgIoAiA2AgggAiADNgIgIAVBAWoiBUGSCUcNAAsLIAEgCTYCMCAAIAk2AjAgCUEANgIYIAlBFGogBjYCACAJQRBqIAE2AgAgCUEANgIMIAkgBzYCCCAJIAA2AgQgCUEANgIAAkAgB0UNACAHQQBBDCAHKAIEIABGG2ogCTYCAAsCQCAGRQ0AIAZBAEEMIAYoAgQgAUYbaiAJNgIACwuqAwEBfyAAQgA3A9ABIABCADcD4AEgAEESNgIEIABBEzYCACAAQgA3A3AgAEIANwO4ASAAQQA2ArABIABCADcDOCAAQdgBakIANwMAIABB6AFqQgA3AwAgAEH4AGpCADcDACAAQcABakIANwMAIABByAFqQgA3AwAgAEHAAGoiA0IANwMAIABByABqQgA3AwAgAEHQAGpCADcDACAAQdgAakIANwMAIABB4ABqQgA3AwAgACABEDwCQCACRAAAAAAAAAAAZg0AQdQJQa0LQZMCQQFBAUHNF0EAEAsQAAALIAAQpwEgACACOQMYIABEAAAAAAAA8H9EAAAAAAAA8D8gAqMgAkQAAAAAAAAAAGEbOQMgIAAQpwEgAEIANwNoIABBmAFqQoCAgICAgID4PzcDACAAQZABakKAgICAgICAgIB/NwMAIABBiAFqQgA3AwAgAEKAgICAgICA+D83A4ABIABBqAFqIAMrAAAgACsDKCICRAAAAAAAAAAAoiAAQTBqKwMAIgGgoTkDACAAQaABaiAAKwA4IAIgAUQAAAAAAAAAAKKhoTkDACAAC/MBAgV8An8gACAAKwA4IAArALgBIAArAEigIAGioCICOQM4IABBwABqIgcgBysAACAAQcABaiIHKwAAIABB0ABqKwAAoCABoqAiAzkDACAAIAArA3AgAEHIAWoiCCsDAKAgAaIgACsDaKAiBDkDaCAAQZgBaiAEEL4BIgE5AwAgAEGIAWogBBDcASIEOQMAIAAgATkDgAEgAEGQAWogBJo5AwAgAEGoAWogAyAEIAArAygiBaIgASAAQTBqKwMAIgaioKE5AwAgAEGgAWogAiAFIAGiIAQgBqKhoTkDACAIQgA3AwAgB0IANwMAIABCADcDuAELxAEBBXwCQAJAIABB6AFqKwMARAAAAAAAAPB/YQ0AIAArAwhEAAAAAAAA8H9hDQELIAErAwghBCABKwMAIQUgACsDeCEGIABCADcDeCAAKwBYIQcgAEIANwNYIABB4ABqIgErAAAhCCABQgA3AwAgACAAKwNwIAKiIAYgACsDIKIgA6KgOQNwIAAgACsASCACoiAFIAcgACsDECIGoqAgA6KgOQNIIABB0ABqIgAgACsAACACoiAEIAYgCKKgIAOioDkDAAsLrgEAAkACQCAAQegBaisDAEQAAAAAAADwf2ENACAAKwMIRAAAAAAAAPB/YQ0AIAFEAAAAAAAAAABmRQ0BIAFEAAAAAAAA8H9jRQ0BIAAQpwEgACABOQMIIABEAAAAAAAA8H9EAAAAAAAA8D8gAaMgAUQAAAAAAAAAAGEbOQMQDwtBjBJBrQtBgQJBAUEBQbMVQQAQCxAAAAtB2BBBrQtBggJBAUEBQfEXQQAQCxAAAAuJAQEDfCAAEKcBIAAgATkDaCAAQZgBaiABEL4BIgI5AwAgAEGIAWogARDcASIBOQMAIAAgAjkDgAEgAEGQAWogAZo5AwAgAEGoAWogAEHAAGorAAAgASAAKwMoIgOiIAIgAEEwaisDACIEoqChOQMAIABBoAFqIAArADggAyACoiABIASioaE5AwALEABBAUHwARD+ASAAIAEQOQvUAwICfwJ8QQFB8AEQ/gEiAEIANwPQASAAQgA3A+ABIABBEjYCBCAAQRM2AgAgAEIANwNwIABCADcDuAEgAEEANgKwASAAQgA3AzggAEHYAWpCADcDACAAQegBaiIBQgA3AwAgAEH4AGpCADcDACAAQcABakIANwMAIABByAFqQgA3AwAgAEHAAGpCADcDACAAQcgAakIANwMAIABB0ABqQgA3AwAgAEHYAGpCADcDACAAQeAAakIANwMAAkACQCABKwMARAAAAAAAAPB/YQ0AIAArAwhEAAAAAAAA8H9iDQELQYwSQa0LQYECQQFBAUGzFUEAEAsQAAALIAAQpwEgAEKAgICAgICA+P8ANwMQIABCADcDCCAAEKcBIABCgICAgICAgPj/ADcDICAAQgA3AxggABCnASAAQgA3A2ggAEGYAWpCgICAgICAgPg/NwMAIABBkAFqQoCAgICAgICAgH83AwAgAEGIAWpCADcDACAAQoCAgICAgID4PzcDgAEgAEGoAWogAEHAAGorAAAgACsDKCICRAAAAAAAAAAAoiAAQTBqKwMAIgOgoTkDACAAQaABaiAAKwA4IAIgA0QAAAAAAAAAAKKhoTkDACAAQQEQQCAAC8EDAQR/QQIhAgJAIABB6AFqKwMARAAAAAAAAPB/YQ0AIAArAwhEAAAAAAAA8H9hIQILAkACQCACIAFGDQAgAEQAAAAAAADwf0QAAAAAAAAAACABQQJGGzkD6AECQAJAIAENACAAQoCAgICAgID4/wA3AyAgAEIANwMIIABCADcDGCAAQoCAgICAgID4/wA3AxAgABBBDAELIABCADcDICAAQoCAgICAgID4/wA3AwggAEKAgICAgICA+P8ANwMYIABCADcDSCAAQgA3AxAgAEIANwNwIABB0ABqQgA3AwALIAAoAtABIgNFDQAgAygCjAENAQJAIAJBAkYiBA0AIAAQpwELAkAgA0HcAEHYACAEG2ooAgAiBCADQdwAQdgAIAFBAkYbaigCACIFRg0AIAQgABAdIAUgABAbCyADQewAQfAAIAJBAkYbaigCACICIANB7ABB8AAgAUECRhtqKAIAIgFGDQAgACgC1AEiAEUNAANAIAIgACAAKAKcASACKAIAKAIUEQAAIAEgACAAKAKcASABKAIAKAIQEQAAIAAoApQBIgANAAsLDwtBngtBrQtBrwFBAUEBQZQWQQAQCxAAAAvmBAIEfwl8AkAgAEUNACAAQegBaisDAEQAAAAAAADwf2ENACAAKwMIRAAAAAAAAPB/YQ0AIABCADcDKCAAQgA3AwggAEIANwMYIABBMGoiAUIANwMAIABBqAFqKwAAIABBiAFqKwAARAAAAAAAAAAAoiAAQZgBaisAAEQAAAAAAAAAAKKgoCEFIABBoAFqKwAAIAArAIABRAAAAAAAAAAAoiAAQZABaisAAEQAAAAAAAAAAKKgoCEGAkAgACgC1AEiAkUNAANAAkAgAisDECIHRAAAAAAAAAAAZEUNACAAIAArAxggByACQRhqKwMAoiAHIAArAwgiCKIgACsAKCIJIAJBIGoiAysAAKEiCiAKoiAAKwAwIgogAkEoaiIEKwAAoSILIAuioKIgByAIoCIIo6CgOQMYIAMrAAAhCyAEKwAAIQwgACAIOQMIIAAgCkQAAAAAAADwPyAHIAijIgehIgiiIAcgDKKgOQMwIAAgCCAJoiAHIAuioDkDKAsgAigClAEiAg0ACwsgAEQAAAAAAADwPyAAKwMIozkDECAARAAAAAAAAPA/IAArAxijOQMgIAAQpwEgACsAmAEhCyAAIAArA2giCBC+ASIHOQOYASAAKwCIASEKIAAgCBDcASIIOQOIASAAKwCAASEMIAAgBzkDgAEgACsAkAEhDSAAIAiaOQOQASAAQcAAaiAFIAogACsAKCIJoiALIAErAAAiCqKgoCILOQMAIAAgBiAMIAmiIAogDaKgoCIMOQM4IAAgCyAJIAiiIAogB6KgoTkDqAEgACAMIAkgB6IgCCAKoqGhOQOgAQsLDwACQCAARQ0AIAAQ+gELCwsAIAAoAuABQQBHCzMBAX9BAiEBAkAgAEHoAWorAwBEAAAAAAAA8H9hDQAgACsDCEQAAAAAAADwf2EhAQsgAQt5AQN8IAFBoAFqKwAAIQIgAUGQAWorAAAhAyABKwCAASEEIAAgAUGoAWorAAAgAUGIAWorAABEAAAAAAAAAACiIAFBmAFqKwAARAAAAAAAAAAAoqCgOQMIIAAgAiAERAAAAAAAAAAAoiADRAAAAAAAAAAAoqCgOQMAC94BAgF/CXwgABCnASAAQZgBaiICKwAAIQMgASsDACEEIAErAwghBSACIAArA2giBhC+ASIHOQMAIABBiAFqIgErAAAhCCABIAYQ3AEiBjkDACAAKwCAASEJIAAgBzkDgAEgAEGQAWoiASsAACEKIAEgBpo5AwAgAEHAAGogBSAIIAArACgiC6IgAyAAQTBqKwAAIgiioKAiAzkDACAAIAQgCSALoiAIIAqioKAiBDkDOCAAQagBaiADIAsgBqIgCCAHoqChOQMAIABBoAFqIAQgCyAHoiAGIAiioaE5AwALIQEBfCABKwOAASECIAAgAUGIAWorAwA5AwggACACOQMAC0MBAX8CQCAAKALUASICRQ0AIAIgATYCmAELIAEgAjYClAEgACABNgLUAQJAIAErAxBEAAAAAAAAAABkRQ0AIAAQQQsLewECfyABKAKYASICQZQBaiAAQdQBaiACGyABKAKUASIDNgIAAkAgA0UNACADIAI2ApgBCyABQgA3ApQBAkAgAEHoAWorAwBEAAAAAAAA8H9hDQAgACsDCEQAAAAAAADwf2ENACABKwMQRAAAAAAAAAAAZEUNACAAEEELCxQAIAAgACgC3AEgACABEEs2AtwBC1UBAX8gACgCCCEDAkAgACACRw0AIABBEEEUIAMgAUYbaigCAA8LAkAgAyABRw0AIAAgACgCECABIAIQSzYCECAADwsgACAAKAIUIAEgAhBLNgIUIAALHQAgACABKQNINwMAIABBCGogAUHQAGopAwA3AwALIgAgABCnASAAQdAAaiABQQhqKQMANwMAIAAgASkDADcDSAsHACAAKwNoCwcAIAArA3ALDgAgABCnASAAIAE5A3ALegEEfEQAAAAAAAAAACEBIAArA3AiAiACoiECRAAAAAAAAAAAIQMCQCAAKwBIIgQgBKIgAEHQAGorAAAiBCAEoqAiBEQAAAAAAAAAAGENACAEIAArAwiiIQMLAkAgAkQAAAAAAAAAAGENACACIAArAxiiIQELIAMgAaALjgEAIABCADcDECAAIAM2AgggACACNgIEIAAgATYCACAAIAQ2AiQgAEEYakIANwMAIABBIGpBADYCAAJAIAEoAgAoAgAgAigCACgCAE0NACAAIAE2AgQgACACNgIACyAAKAIAIgEgACgCBCICIAAgAigCACgCAEEDbCABKAIAKAIAakECdEHwImooAgARAAALrgIBCHwCQCABKwCwASAAKwCwAaEiAyADoiABQbgBaisAACAAQbgBaisAAKEiBCAEoqAiBSAAKwPAASABKwPAAaAiBiAGomNFDQBEAAAAAAAAAAAhBgJAAkAgBZ8iBUQAAAAAAAAAAGINAEQAAAAAAADwPyEDDAELIAREAAAAAAAA8D8gBaMiBaIhBiADIAWiIQMLIAIgAzkDECACQRhqIAY5AwAgACsAsAEhByAAKwC4ASEIIAArA8ABIQQgASsAsAEhCSABKwC4ASEKIAErA8ABIQUgAigCJCACKAIgQeAAbGoiAUEANgJYIAFBGGogCiAGIAWioTkDACABIAkgAyAFoqE5AxAgASAIIAYgBKKgOQMIIAEgByADIASioDkDACACIAIoAiBBAWo2AiALCxkAQYYKQfUOQa4FQQFBAUGGHUEAEAsQAAAL8QQCAn8LfCMAQRBrIgMkAAJAIAErA9ABIgUgASsD4AEgBaEiBiAGIAArA7ABIgcgBaGiIAFB6AFqKwMAIAFB2AFqKwMAIgihIgUgAEG4AWorAwAiCSAIoaKgIAYgBqIgBSAFoqCjIgZEAAAAAAAA8D8gBkQAAAAAAADwP2MbRAAAAAAAAAAApSIGoqAiCiAHoSILIAuiIAggBSAGoqAiDCAJoSIFIAWioCINIAArA8ABIAErA4ACoCIIIAiiY0UNAAJAAkAgDZ8iCEQAAAAAAAAAAGENACACQRhqIAVEAAAAAAAA8D8gCKMiCKI5AwAgAiALIAiiOQMQDAELIAIgASkD8AE3AxAgAkEYaiABQfgBaikDADcDAAsgAkEYaisDACEFIAIrAxAhCAJAAkAgASgCCCIERQ0AIAMgBBBHDAELIANCADcDCCADQoCAgICAgID4PzcDAAsCQCAGRAAAAAAAAAAAYg0AIAggASsAiAIiCyADKwMAIg2iIAMrAwgiDiABQZACaisAACIPoqGiIAUgCyAOoiANIA+ioKKgRAAAAAAAAAAAZkUNAQsCQCAGRAAAAAAAAPA/Yg0AIAggASsAmAIiBiADKwMAIguiIAMrAwgiDSABQaACaisAACIOoqGiIAUgBiANoiALIA6ioKKgRAAAAAAAAAAAZkUNAQsgACsDwAEhBiABKwOAAiELIAIoAiQgAigCIEHgAGxqIgFBADYCWCABIAogCCALoqE5AxAgASAJIAUgBqKgOQMIIAEgByAIIAaioDkDACABQRhqIAwgBSALoqE5AwAgAiACKAIgQQFqNgIgCyADQRBqJAAL1QsDA38KfAF+IwBB0ANrIgMkACADQRQ2AswDIANBFDYCyAMgAyABNgLEAyADIAA2AsADIANBgANqIANBwANqIAJBCGoQWCADQagDaisDACEGIAMrA6ADIQcCQAJAIAAoAggiBEUNACADQfACaiAEEEcMAQsgA0IANwP4AiADQoCAgICAgID4PzcD8AILAkACQCABKAIIIgRFDQAgA0HgAmogBBBHDAELIANCADcD6AIgA0KAgICAgICA+D83A+ACCwJAIAMrA7ADIAArA4ACIgggASsDgAIiCaBlRQ0AIAMrA4gDIQoCQCADKwOAAyILIAArANABYg0AIAogAEHYAWorAABiDQAgByAAKwCIAiIMIAMrA/ACIg2iIAMrA/gCIg4gAEGQAmorAAAiD6KhoiAGIAwgDqIgDSAPoqCioEQAAAAAAAAAAGVFDQELAkAgCyAAKwDgAWINACAKIABB6AFqKwAAYg0AIAcgACsAmAIiCiADKwPwAiILoiADKwP4AiIMIABBoAJqKwAAIg2ioaIgBiAKIAyiIAsgDaKgoqBEAAAAAAAAAABlRQ0BCyADQZgDaisDACEKAkAgAysDkAMiCyABKwDQAWINACAKIAFB2AFqKwAAYg0AIAcgASsAiAIiDCADKwPgAiINoiADKwPoAiIOIAFBkAJqKwAAIg+ioaIgBiAMIA6iIA0gD6KgoqBEAAAAAAAAAABmRQ0BCwJAIAsgASsA4AFiDQAgCiABQegBaisAAGINACAHIAErAJgCIgogAysD4AIiC6IgAysD6AIiDCABQaACaisAACINoqGiIAYgCiAMoiALIA2ioKKgRAAAAAAAAAAAZkUNAQsgACgCnAEhBAJAAkAgACsA8AEiCiAHoiAGIABB+AFqIgUrAAAiC6KgRAAAAAAAAAAAZEUNACADQaACaiAAQdgBaikDADcDACADIAApA9ABNwOYAiADIARB4eP9unxsIgQ2AqgCIANBuAJqIABB6AFqKQMANwMAIAApA+ABIRAgA0HAAmogBEHh4/26fHM2AgAgAyAQNwOwAiADIAg5A8gCIANB2AJqIAUpAwA3AwAgAyAAKQPwATcD0AIMAQsgA0GgAmogAEHoAWopAwA3AwAgAyAAKQPgATcDmAIgAyAEQeHj/bp8bCIEQeHj/bp8czYCqAIgA0G4AmogAEHYAWopAwA3AwAgACkD0AEhECADQdgCaiALmjkDACADQcACaiAENgIAIAMgEDcDsAIgAyAKmjkD0AIgAyAIOQPIAgsgASgCnAEhAAJAAkAgASsA8AEiCCAHmqIgAUH4AWoiBCsAACIHIAaioUQAAAAAAAAAAGRFDQAgA0HYAWogAUHYAWopAwA3AwAgAyABKQPQATcD0AEgAyAAQeHj/bp8bCIANgLgASADQfABaiABQegBaikDADcDACABKQPgASEQIANB+AFqIABB4eP9unxzNgIAIAMgEDcD6AEgAyAJOQOAAiADQZACaiAEKQMANwMAIAMgASkD8AE3A4gCDAELIANB2AFqIAFB6AFqKQMANwMAIAMgASkD4AE3A9ABIAMgAEHh4/26fGwiAEHh4/26fHM2AuABIANB8AFqIAFB2AFqKQMANwMAIAEpA9ABIRAgA0GQAmogB5o5AwAgA0H4AWogADYCACADIBA3A+gBIAMgCJo5A4gCIAMgCTkDgAILIANBiAFqIANBmAJqQcgAEL8BGiADQcAAaiADQdABakHIABC/ARogA0E4aiADQYADakE4aikDADcDACADQTBqIANBgANqQTBqKQMANwMAIANBKGogA0GAA2pBKGopAwA3AwAgA0EgaiADQYADakEgaikDADcDACADQRhqIANBgANqQRhqKQMANwMAIANBEGogA0GAA2pBEGopAwA3AwAgA0EIaiADQYADakEIaikDADcDACADIAMpA4ADNwMAIANBiAFqIANBwABqIAMgAhBZCyADQdADaiQAC3QCAnwBfiAAIAFB0AFqIAFB4AFqIAErANABIAIrAwAiA6IgAUHYAWorAAAgAisDCCIEoqAgASsA4AEgA6IgBCABQegBaisAAKKgZCIBGyICKQAANwAAIAJBCGopAAAhBSAAIAFBAXM2AhAgAEEIaiAFNwAAC74PAgd/BnwjAEHwAmsiAyQAIAEoAgAhBAJAAkAgAigCACIFRQ0AIAVBGHYhBkQAAAAAAAAAACEKQQAhB0EAIQhEAAAAAAAAAAAhC0QAAAAAAAAAACEMAkACQAJAAkAgBCgCACgCAA4DAAECAwsgBEG4AWorAAAhCyAEQbABaisAACEMQQAhCAwCCwJAIAVB////B0sNACAEQdgBaisDACELIARB0AFqKwMAIQwgBiEIDAILIARB6AFqKwMAIQsgBEHgAWorAwAhDCAGIQgMAQsgBCgCrAEgBkEAIARBqAFqKAIAIAZKGyIIQQV0aiIGKwAIIQsgBisAACEMCyAFQRB2Qf8BcSEJRAAAAAAAAAAAIQ0CQAJAAkACQCABKAIEIgYoAgAoAgAOAwABAgMLIAZBuAFqKwAAIQogBkGwAWorAAAhDQwCCwJAIAkNACAGQdgBaisDACEKIAZB0AFqKwMAIQ0gCSEHDAILIAZB6AFqKwMAIQogBkHgAWorAwAhDSAJIQcMAQsgBigCrAEgCUEAIAZBqAFqKAIAIAlKGyIHQQV0aiIJKwAIIQogCSsAACENCyADQYACaiAKOQMAIAMgCzkD8AEgA0GQAmogCiALoTkDACADIAcgCEEIdHI2ApgCIAMgDDkD6AEgAyANOQP4ASADIA0gDKE5A4gCIAVBCHZB/wFxIQlEAAAAAAAAAAAhCkEAIQdBACEIRAAAAAAAAAAAIQ1EAAAAAAAAAAAhDAJAAkACQAJAIAQoAgAoAgAOAwABAgMLIARBuAFqKwAAIQ0gBEGwAWorAAAhDEEAIQgMAgsCQCAJDQAgBEHYAWorAwAhDSAEQdABaisDACEMIAkhCAwCCyAEQegBaisDACENIARB4AFqKwMAIQwgCSEIDAELIAQoAqwBIAlBACAEQagBaigCACAJShsiCEEFdGoiBCsACCENIAQrAAAhDAsgBUH/AXEhBEQAAAAAAAAAACELAkACQAJAAkAgBigCACgCAA4DAAECAwsgBkG4AWorAAAhCiAGQbABaisAACELDAILAkAgBA0AIAZB2AFqKwMAIQogBkHQAWorAwAhCyAEIQcMAgsgBkHoAWorAwAhCiAGQeABaisDACELIAQhBwwBCyAGKAKsASAEQQAgBkGoAWooAgAgBEobIgdBBXRqIgQrAAghCiAEKwAAIQsLIAogDaEhDiAHIAhBCHRyIQUgAyAMOQOwASALIAyhIQwMAQsgASgCBCIFQcAAaisAACENIAVB0ABqKwAAIQsgBEHAAGorAAAhDCAEQdAAaisAACEOIANByAJqQQhqIgYgBCsAOEQAAAAAAADgP6IgBEHIAGorAABEAAAAAAAA4D+ioCAFKwA4RAAAAAAAAOA/oiAFQcgAaisAAEQAAAAAAADgP6KgoSIKOQMAIAMgDEQAAAAAAADgP6IgDkQAAAAAAADgP6KgIA1EAAAAAAAA4D+iIAtEAAAAAAAA4D+ioKEiDZoiCzkDyAIgASgCCCEFIANBsAJqQQhqIgggCpoiDDkDACADIA05A7ACIANBoAFqQQhqIAgpAwA3AwAgAyADKQOwAjcDoAEgA0GwAWogBCADQaABaiAFEQAAIAEoAgQhBCABKAIMIQUgA0GQAWpBCGogBikDADcDACADIAMpA8gCNwOQASADQdgCaiAEIANBkAFqIAURAAAgA0GAAmogAysD4AIiDjkDACADQZACaiAOIAMrA7gBIg+hOQMAIAMgAysD2AIiDjkD+AEgAyAPOQPwASADIAMrA7ABIg85A+gBIAMgDiAPoTkDiAIgAyADKALAAUEIdEGA/gNxIAMtAOgCcjYCmAIgA0GgAmpBCGoiBCAMOQMAIAMgDTkDoAIgASgCACEFIAEoAgghCCAGIAo5AwAgAyALOQPIAiADQYABakEIaiAGKQMANwMAIAMgAykDyAI3A4ABIANB2AJqIAUgA0GAAWogCBEAACABKAIEIQUgASgCDCEGIANB8ABqQQhqIAQpAwA3AwAgAyADKQOgAjcDcCADQbACaiAFIANB8ABqIAYRAAAgAyADKwPYAiIMOQOwASADKwO4AiIKIAMrA+ACIg2hIQ4gAysDsAIiCyAMoSEMIAMoAugCQQh0QYD+A3EgAy0AwAJyIQULIANBsAFqQTBqIgQgBTYCACADQbABakEQaiIFIAs5AwAgA0GwAWpBCGoiBiANOQMAIANBsAFqQRhqIgggCjkDACADQbABakEgaiIHIAw5AwAgA0GwAWpBKGoiCSAOOQMAIANBOGpBCGogA0HoAWpBCGopAwA3AwAgA0E4akEQaiADQegBakEQaikDADcDACADQThqQRhqIANB6AFqQRhqKQMANwMAIANBOGpBIGogA0HoAWpBIGopAwA3AwAgA0E4akEoaiADQegBakEoaikDADcDACADQThqQTBqIANB6AFqQTBqKQMANwMAIAMgAykD6AE3AzggA0EwaiAEKQMANwMAIANBKGogCSkDADcDACADQSBqIAcpAwA3AwAgA0EYaiAIKQMANwMAIANBEGogBSkDADcDACADQQhqIAYpAwA3AwAgAyADKQOwATcDACAAIAEgA0E4aiADQQEQXyACIAAoAjg2AgAgA0HwAmokAAu5BgIZfAJ/AkAgAisDMCAAKwMwIgQgASsDMCIFoGVFDQAgAyACKQMgNwMQIANBGGoiHSACQShqKQMANwMAAkAgAysDECIGIAWaIgeiIgggASsDGCIJIAArAwAiCiAdKwMAIgWiIAYgACsDCCILoqEiDCABKwMAIg0gBaIgBiABKwMIIg6ioSIPoUQAAAAAAADwPyAJIAWiIAYgAUEgaisDACIQoqEiESAPoUQAAAAAAAAQAKCjIhKiIhNEAAAAAAAA8D8gE0QAAAAAAADwP2MbRAAAAAAAAAAApSIToiANRAAAAAAAAPA/IBOhIhSioKAiFSAEIAaiIhYgACsDGCIXRAAAAAAAAPA/IBcgBaIgBiAAQSBqKwMAIhiioSIZIAyhRAAAAAAAABAAoKMiGiARIAyhoiIRRAAAAAAAAPA/IBFEAAAAAAAA8D9jG0QAAAAAAAAAAKUiEaIgCkQAAAAAAADwPyARoSIboqCgIhyhIAaiIAUgBSAHoiIHIBAgE6IgDiAUoqCgIhQgBCAFoiITIBggEaIgCyAboqCgIgShoqBEAAAAAAAAAABlRQ0AIAFBKGooAgAhHSAAKAIQIR4gAygCJCADKAIgQeAAbGoiAiAVOQMQIAIgBDkDCCACIBw5AwAgAiAdQeHj/bp8bCAeQeHj/bp8bHM2AlggAkEYaiAUOQMAIAMgAygCIEEBajYCIAsgCCAJIBkgD6EgEqIiBEQAAAAAAADwPyAERAAAAAAAAPA/YxtEAAAAAAAAAAClIgSiIA1EAAAAAAAA8D8gBKEiCaKgoCINIBYgFyAPIAyhIBqiIgxEAAAAAAAA8D8gDEQAAAAAAADwP2MbRAAAAAAAAAAApSIMoiAKRAAAAAAAAPA/IAyhIg+ioKAiCqEgBqIgBSAHIBAgBKIgDiAJoqCgIgYgEyAYIAyiIAsgD6KgoCIEoaKgRAAAAAAAAAAAZUUNACAAQShqKAIAIQIgASgCECEBIAMoAiQgAygCIEHgAGxqIgAgDTkDECAAIAQ5AwggACAKOQMAIAAgAUHh4/26fGwgAkHh4/26fGxzNgJYIABBGGogBjkDACADIAMoAiBBAWo2AiALC48CAgJ/CHwjAEHQAGsiAyQAIANBFTYCTCADQRY2AkggAyABNgJEIAMgADYCQCADIANBwABqIAJBCGoQWAJAIAMrAzAgACsDwAEgASsDoAGgZUUNACACQRhqIgQgA0EoaikDADcDACACIAMpAyA3AxAgBCsDACEFIAArA8ABIQYgAisDECEHIANBGGorAwAhCCABKwOgASEJIAMrAwAhCiADKwMIIQsgAysDECEMIAIoAiQgAigCIEHgAGxqIgBBADYCWCAAQRhqIAggBSAJoqE5AwAgACAMIAcgCaKhOQMQIAAgCyAFIAaioDkDCCAAIAogByAGoqA5AwAgAiACKAIgQQFqNgIgCyADQdAAaiQAC7ABAgN/BHwgASgCrAEhA0EAIQQCQAJAIAEoAqgBIgVBAU4NAEEAIQEMAQsgAisDCCEGIAIrAwAhB0QAAAAAAADw/yEIQQAhAQNAIAMgBEEFdGoiAisDACAHoiAGIAIrAwiioCIJIAggCSAIZCICGyEIIAQgASACGyEBIARBAWoiBCAFRw0ACwsgACADIAFBBXRqIgQpAAA3AAAgAEEIaiAEQQhqKQAANwAAIAAgATYCEAslACAAIAEpALABNwAAIABBCGogAUG4AWopAAA3AAAgAEEANgIQC/kKAwd/CnwBfiMAQcADayIDJAAgA0EVNgK8AyADQRQ2ArgDIAMgATYCtAMgAyAANgKwAyADQfACaiADQbADaiACQQhqEFggA0GYA2orAwAhCiADKwOQAyELAkACQCAAKAIIIgRFDQAgA0HgAmogBBBHDAELIANCADcD6AIgA0KAgICAgICA+D83A+ACCwJAIAMrA6ADIAArA4ACIgyhIAErA6ABIg2hRAAAAAAAAAAAZUUNACADKwP4AiEOAkAgAysD8AIiDyAAKwDQAWINACAOIABB2AFqKwAAYg0AIAsgACsAiAIiECADKwPgAiIRoiADKwPoAiISIABBkAJqKwAAIhOioaIgCiAQIBKiIBEgE6KgoqBEAAAAAAAAAABlRQ0BCwJAIA8gACsA4AFiDQAgDiAAQegBaisAAGINACALIAArAJgCIg4gAysD4AIiD6IgAysD6AIiECAAQaACaisAACIRoqGiIAogDiAQoiAPIBGioKKgRAAAAAAAAAAAZUUNAQsgACgCnAEhBAJAAkAgACsA8AEiDiALoiAKIABB+AFqIgUrAAAiD6KgRAAAAAAAAAAAZEUNACADQaACaiAAQdgBaikDADcDACADIAApA9ABNwOYAiADIARB4eP9unxsIgQ2AqgCIANBuAJqIABB6AFqKQMANwMAIAApA+ABIRQgA0HAAmogBEHh4/26fHM2AgAgAyAUNwOwAiADIAw5A8gCIANB2AJqIAUpAwA3AwAgAyAAKQPwATcD0AIMAQsgA0GgAmogAEHoAWopAwA3AwAgAyAAKQPgATcDmAIgAyAEQeHj/bp8bCIEQeHj/bp8czYCqAIgA0G4AmogAEHYAWopAwA3AwAgACkD0AEhFCADQdgCaiAPmjkDACADQcACaiAENgIAIAMgFDcDsAIgAyAOmjkD0AIgAyAMOQPIAgsgASgCrAEhBiAKmiEMIAuaIQ5BACEAAkACQCABKAKoASIHQQFODQBBACEEDAELRAAAAAAAAPD/IQpBACEEA0AgBiAAQQV0aiIFKwMAIA6iIAUrAwggDKKgIgsgCiALIApkIgUbIQogACAEIAUbIQQgAEEBaiIAIAdHDQALCyAHIARqQX9qIAdvIQggASgCnAEhAQJAAkAgDiAGIARBBXRqIgArABCiIABBGGorAAAgDKKgIA4gBiAEQQFqIAdvIglBBXRqIgUrABCiIAVBGGorAAAgDKKgZEUNACAAQRBqIQcgA0HQAWpBCGogBiAIQQV0aiIFQQhqKQMANwMAIAMgBSkDADcD0AEgAyABQeHj/bp8bCIGIAhB4eP9unxsczYC4AEgA0HwAWogAEEIaikDADcDACADIAApAwA3A+gBDAELIAVBEGohByADQdABakEIaiAAQQhqKQMANwMAIAMgACkDADcD0AEgAyABQeHj/bp8bCIGIARB4eP9unxsczYC4AEgA0HwAWogBUEIaikDADcDACADIAUpAwA3A+gBIAkhBAsgA0HQAWpBKGogBiAEQeHj/bp8bHM2AgAgAyANOQOAAiADQZACaiAHQQhqKQMANwMAIAMgBykDADcDiAIgA0GIAWogA0GYAmpByAAQvwEaIANBwABqIANB0AFqQcgAEL8BGiADQThqIANB8AJqQThqKQMANwMAIANBMGogA0HwAmpBMGopAwA3AwAgA0EoaiADQfACakEoaikDADcDACADQSBqIANB8AJqQSBqKQMANwMAIANBGGogA0HwAmpBGGopAwA3AwAgA0EQaiADQfACakEQaikDADcDACADQQhqIANB8AJqQQhqKQMANwMAIAMgAykD8AI3AwAgA0GIAWogA0HAAGogAyACEFkLIANBwANqJAALiAoCCH8GfCMAQbADayIDJAAgA0EVNgKsAyADQRU2AqgDIAMgATYCpAMgAyAANgKgAyADQeACaiADQaADaiACQQhqEFgCQCADKwOQAyAAKwOgASILoSABKwOgASIMoUQAAAAAAAAAAGVFDQAgACgCrAEhBCADQYgDaisDACENQQAhBSADKwOAAyEOAkACQCAAKAKoASIGQQFODQBBACEHDAELRAAAAAAAAPD/IQ9BACEHA0AgBCAFQQV0aiIIKwMAIA6iIA0gCCsDCKKgIhAgDyAQIA9kIggbIQ8gBSAHIAgbIQcgBUEBaiIFIAZHDQALCyAGIAdqQX9qIAZvIQkgACgCnAEhAAJAAkAgDiAEIAdBBXRqIgUrABCiIA0gBUEYaisAAKKgIA4gBCAHQQFqIAZvIgpBBXRqIggrABCiIA0gCEEYaisAAKKgZEUNACAFQRBqIQYgA0GYAmpBCGogBCAJQQV0aiIIQQhqKQMANwMAIAMgCCkDADcDmAIgAyAAQeHj/bp8bCIEIAlB4eP9unxsczYCqAIgA0G4AmogBUEIaikDADcDACADIAUpAwA3A7ACDAELIAhBEGohBiADQZgCakEIaiAFQQhqKQMANwMAIAMgBSkDADcDmAIgAyAAQeHj/bp8bCIEIAdB4eP9unxsczYCqAIgA0G4AmogCEEIaikDADcDACADIAgpAwA3A7ACIAohBwsgA0HAAmogBCAHQeHj/bp8bHM2AgAgAyALOQPIAiADQdgCaiAGQQhqKQMANwMAIAMgBikDADcD0AIgDZohDSAOmiEOIAEoAqwBIQRBACEFAkACQCABKAKoASIGQQFODQBBACEHDAELRAAAAAAAAPD/IQ9BACEHA0AgBCAFQQV0aiIIKwMAIA6iIAgrAwggDaKgIhAgDyAQIA9kIggbIQ8gBSAHIAgbIQcgBUEBaiIFIAZHDQALCyAGIAdqQX9qIAZvIQAgASgCnAEhAQJAAkAgDiAEIAdBBXRqIgUrABCiIAVBGGorAAAgDaKgIA4gBCAHQQFqIAZvIglBBXRqIggrABCiIAhBGGorAAAgDaKgZEUNACAFQRBqIQYgA0HQAWpBCGogBCAAQQV0aiIIQQhqKQMANwMAIAMgCCkDADcD0AEgAyABQeHj/bp8bCIEIABB4eP9unxsczYC4AEgA0HwAWogBUEIaikDADcDACADIAUpAwA3A+gBDAELIAhBEGohBiADQdABakEIaiAFQQhqKQMANwMAIAMgBSkDADcD0AEgAyABQeHj/bp8bCIEIAdB4eP9unxsczYC4AEgA0HwAWogCEEIaikDADcDACADIAgpAwA3A+gBIAkhBwsgA0HQAWpBKGogBCAHQeHj/bp8bHM2AgAgAyAMOQOAAiADQZACaiAGQQhqKQMANwMAIAMgBikDADcDiAIgA0GIAWogA0GYAmpByAAQvwEaIANBwABqIANB0AFqQcgAEL8BGiADQThqIANB4AJqQThqKQMANwMAIANBMGogA0HgAmpBMGopAwA3AwAgA0EoaiADQeACakEoaikDADcDACADQSBqIANB4AJqQSBqKQMANwMAIANBGGogA0HgAmpBGGopAwA3AwAgA0EQaiADQeACakEQaikDADcDACADQQhqIANB4AJqQQhqKQMANwMAIAMgAykD4AI3AwAgA0GIAWogA0HAAGogAyACEFkLIANBsANqJAALxR8DCH8SfAd+IwBB8AZrIgUkAAJAAkAgBEEfSA0AIAJBGGorAwAhDSADQRhqKwMAIQ4gAigCMCEEIAIrAxAhDyACKwMIIRAgAisDACERIAMvATAhASADKwMQIRIgAysDCCETIAMrAwAhFEQAAAAAAAAAACEVAkAgAysDICIWIAIrAyAiF6EiGCAYoiADQShqKwMAIhkgAkEoaisDACIaoSIbIBuioCIcRAAAAAAAAAAAYQ0AIBggFiAXoKIgGyAZIBqgoqAgHKMiHUQAAAAAAADwvyAdRAAAAAAAAPC/ZBsiHUQAAAAAAADwPyAdRAAAAAAAAPA/YxuaIRULIA4gFUQAAAAAAADgP6IiHkQAAAAAAADgP6AiHaIgDUQAAAAAAADgPyAeoSIOoqAhDSASIB2iIA8gDqKgIQ8gEyAdoiAQIA6ioCEQIBQgHaIgESAOoqAhESAEQRB0IAFyIQICQAJAIBtEAAAAAAAA8D8gHJ9EAAAAAAAAEACgoyIcoiIbIBcgDqIgFiAdoqAiFqIgHCAYmqIiGCAaIA6iIBkgHaKgIh2ioCIORAAAAAAAAAAAZQ0AIBVEAAAAAAAA8L9kRQ0BIBVEAAAAAAAA8D9jRQ0BCyAAIAI2AjggACAOOQMwIAAgGzkDICAAIA85AxAgACAQOQMIIAAgETkDACAAQShqIBg5AwAgAEEYaiANOQMADAILIAAgAjYCOCAAIA85AxAgACAQOQMIIAAgETkDACAAQRhqIA05AwAgACAWIBaiIB0gHaKgnyIOOQMwIABBKGogHUQAAAAAAADwPyAORAAAAAAAABAAoKMiDqI5AwAgACAWIA6iOQMgDAELIAVBsARqQQhqIANBKGoiBikDADcDACAFIAMpAyA3A7AEIAVBoARqQQhqIAJBKGoiBykDADcDACACKQMgIR8gBUGQBGpBCGpCADcDACAFIB83A6AEIAVCADcDkAQgAkEgaiEIIANBIGohCQJAIAVBsARqIAVBoARqIAVBkARqEIABRQ0AIAVB2ANqQTBqIANBMGopAwA3AwAgBUHYA2pBKGogBikDADcDACAFQdgDakEgaiAJKQMANwMAIAVB2ANqQRhqIANBGGopAwA3AwAgBUHYA2pBEGogA0EQaikDADcDACAFQdgDakEIaiADQQhqKQMANwMAIAUgAykDADcD2AMgBUGgA2pBCGogAkEIaikDADcDACAFQaADakEQaiACQRBqKQMANwMAIAVBoANqQRhqIAJBGGopAwA3AwAgBUGgA2pBIGogCCkDADcDACAFQaADakEoaiAHKQMANwMAIAVBoANqQTBqIAJBMGopAwA3AwAgBSACKQMANwOgAyAAIAEgBUHYA2ogBUGgA2ogBBBfDAELRAAAAAAAAAAAIQ4CQCADKwMgIhsgAisDICIVoSIdIB2iIAYrAwAiFiAHKwMAIhehIhggGKKgIhlEAAAAAAAAAABhDQAgHSAbIBWgoiAYIBYgF6CioCAZoyIORAAAAAAAAPC/IA5EAAAAAAAA8L9kGyIORAAAAAAAAPA/IA5EAAAAAAAA8D9jG5ohDgsCQAJAIA5EAAAAAAAA8L9kRQ0AIA5EAAAAAAAA8D9jRQ0AIAUgGJo5A/gEDAELIAUgFUQAAAAAAADgPyAORAAAAAAAAOA/oiIdoSIOoiAbIB1EAAAAAAAA4D+gIh2ioJo5A/gEIBcgDqIgFiAdoqCaIR0LIAVB+ARqQQhqIgcgHTkDACAFQYgFakEIaiIGIAcpAwA3AwAgBSAFKQP4BDcDiAUgASgCACEKIAEoAgghCyAFQbAFakEIaiIMIAYrAwCaOQMAIAVBkANqQQhqIAwpAwA3AwAgBSAFKwOIBZo5A7AFIAUgBSkDsAU3A5ADIAVBwAVqIAogBUGQA2ogCxEAACABKAIEIQogASgCDCELIAVBgANqQQhqIAYpAwA3AwAgBSAFKQOIBTcDgAMgBUGYBWogCiAFQYADaiALEQAAIAVB6ARqIgYgBSsDoAUiHSAFKwPIBSIOoTkDACAFQdgEaiAdOQMAIAVB8AJqQQhqIAYpAwA3AwAgBSAFKwOYBSIdIAUrA8AFIhihOQPgBCAFIB05A9AEIAUgDjkDyAQgBSAYOQPABCAFIAUoAtAFQQh0QYD+A3EgBS0AqAVyNgLwBCAFIAUpA+AENwPwAiAFQeACakEIaiAIQQhqIgopAwA3AwAgBSAIKQMANwPgAiAFQdACakEIakIANwMAIAVCADcD0AIgBUHgBGohBgJAIAVB8AJqIAVB4AJqIAVB0AJqEIABRQ0AIAVBwAJqQQhqIAlBCGopAwA3AwAgBSAJKQMANwPAAiAFQbACakEIaiAGQQhqKQMANwMAIAYpAwAhHyAFQaACakEIakIANwMAIAUgHzcDsAIgBUIANwOgAiAFQcACaiAFQbACaiAFQaACahCAAUUNACACQQhqKQMAIR8gAkEQaikDACEgIAJBGGopAwAhISACQSBqKQMAISIgAkEoaikDACEjIAJBMGopAwAhJCACKQMAISUgBUGoBmogBUHABGpBMGopAwA3AwAgBUGgBmogBUHABGpBKGopAwA3AwAgBUGYBmogBUHABGpBIGopAwA3AwAgBUGQBmogBUHABGpBGGopAwA3AwAgBUGIBmogBUHABGpBEGopAwA3AwAgBUGABmogBUHABGpBCGopAwA3AwAgBUHABWpBMGogJDcDACAFQcAFakEoaiAjNwMAIAVBwAVqQSBqICI3AwAgBUHABWpBGGogITcDACAFQcAFakEQaiAgNwMAIAUgJTcDwAUgBSAFKQPABDcD+AUgBSAfNwPIBSAFQeAGaiADQTBqKQMANwMAIAVB2AZqIANBKGopAwA3AwAgBUHQBmogA0EgaikDADcDACAFQcgGaiADQRhqKQMANwMAIAVBwAZqIANBEGopAwA3AwAgBUG4BmogA0EIaikDADcDACAFIAMpAwA3A7AGIAAgAUEDIAVBwAVqQQEQYAwBCyAFQZACakEIaiAKKQMANwMAIAUgCCkDADcDkAIgBUGAAmpBCGogCUEIaikDADcDACAFIAkpAwA3A4ACIAZBCGopAwAhHyAGKQMAISAgBUHgAWpBCGogBykDADcDACAFQfABakEIaiAfNwMAIAUgBSkD+AQ3A+ABIAUgIDcD8AECQCAFQZACaiAFQYACaiAFQfABaiAFQeABahCBAUUNACACQRhqKwMAIQ0gA0EYaisDACEOIAIoAjAhBCACKwMQIQ8gAisDCCEQIAIrAwAhESADLwEwIQEgAysDECESIAMrAwghEyADKwMAIRREAAAAAAAAAAAhFQJAIAMrAyAiFiACKwMgIhehIhggGKIgAysDKCIZIAIrAygiGqEiGyAboqAiHEQAAAAAAAAAAGENACAYIBYgF6CiIBsgGSAaoKKgIByjIh1EAAAAAAAA8L8gHUQAAAAAAADwv2QbIh1EAAAAAAAA8D8gHUQAAAAAAADwP2MbmiEVCyAOIBVEAAAAAAAA4D+iIh5EAAAAAAAA4D+gIh2iIA1EAAAAAAAA4D8gHqEiDqKgIQ0gEiAdoiAPIA6ioCEPIBMgHaIgECAOoqAhECAUIB2iIBEgDqKgIREgBEEQdCABciECAkACQCAbRAAAAAAAAPA/IByfRAAAAAAAABAAoKMiHKIiEiAXIA6iIBYgHaKgIhuiIBwgGJqiIhggGiAOoiAZIB2ioCIdoqAiDkQAAAAAAAAAAGUNACAVRAAAAAAAAPC/ZEUNASAVRAAAAAAAAPA/Y0UNAQsgACACNgI4IAAgDjkDMCAAIBI5AyAgACAPOQMQIAAgEDkDCCAAIBE5AwAgAEEoaiAYOQMAIABBGGogDTkDAAwCCyAAIAI2AjggACAPOQMQIAAgEDkDCCAAIBE5AwAgAEEYaiANOQMAIAAgGyAboiAdIB2ioJ8iDjkDMCAAQShqIB1EAAAAAAAA8D8gDkQAAAAAAAAQAKCjIg6iOQMAIAAgGyAOojkDIAwBC0QAAAAAAAAAACEYRAAAAAAAAAAAIRsCQCAFKwPgBCIdIAIrAyAiFaEiFiAWoiAFKwPoBCIOIAIrAygiF6EiGSAZoqAiGkQAAAAAAAAAAGENACAWIB0gFaCiIBkgDiAXoKKgIBqjIhtEAAAAAAAA8L8gG0QAAAAAAADwv2QbIhtEAAAAAAAA8D8gG0QAAAAAAADwP2MbRAAAAAAAAOC/oiEbCyAVRAAAAAAAAOA/IBuhIhaiIB0gG0QAAAAAAADgP6AiG6KgIhUgFaIgFyAWoiAOIBuioCIbIBuioCEZAkAgAysDICIbIB2hIhUgFaIgAysDKCIWIA6hIhcgF6KgIhpEAAAAAAAAAABhDQAgFSAdIBugoiAXIA4gFqCioCAaoyIYRAAAAAAAAPC/IBhEAAAAAAAA8L9kGyIYRAAAAAAAAPA/IBhEAAAAAAAA8D9jG0QAAAAAAADgv6IhGAsgBEEBaiEEAkAgGSAdRAAAAAAAAOA/IBihIhWiIBsgGEQAAAAAAADgP6AiHaKgIhggGKIgDiAVoiAWIB2ioCIdIB2ioGNFDQAgBUE4akEwaiACQTBqKQMANwMAIAVBOGpBKGogAkEoaikDADcDACAFQThqQSBqIAJBIGopAwA3AwAgBUE4akEYaiACQRhqKQMANwMAIAVBOGpBEGogAkEQaikDADcDACAFQThqQQhqIAJBCGopAwA3AwAgAikDACEfIAVBCGogBUHABGpBCGopAwA3AwAgBUEQaiAFQcAEakEQaikDADcDACAFQRhqIAVBwARqQRhqKQMANwMAIAVBIGogBUHABGpBIGopAwA3AwAgBUEoaiAFQcAEakEoaikDADcDACAFQTBqIAVBwARqQTBqKQMANwMAIAUgHzcDOCAFIAUpA8AENwMAIAAgASAFQThqIAUgBBBfDAELIAVBqAFqQTBqIAVBwARqQTBqKQMANwMAIAVBqAFqQShqIAVBwARqQShqKQMANwMAIAVBqAFqQSBqIAVBwARqQSBqKQMANwMAIAVBqAFqQRhqIAVBwARqQRhqKQMANwMAIAVBqAFqQRBqIAVBwARqQRBqKQMANwMAIAVBqAFqQQhqIAVBwARqQQhqKQMANwMAIAUgBSkDwAQ3A6gBIAVB8ABqQQhqIANBCGopAwA3AwAgBUHwAGpBEGogA0EQaikDADcDACAFQfAAakEYaiADQRhqKQMANwMAIAVB8ABqQSBqIANBIGopAwA3AwAgBUHwAGpBKGogA0EoaikDADcDACAFQfAAakEwaiADQTBqKQMANwMAIAUgAykDADcDcCAAIAEgBUGoAWogBUHwAGogBBBfCyAFQfAGaiQAC6sTAhF/EnwjAEGwA2siBSEGIAUkAAJAAkAgAkEBTg0AQQAhBwwBCyACQX9qIQhEAAAAAAAA8H8hFkEAIQdBACEJA0BEAAAAAAAAAAAhFwJAIAMgCSIJQThsaiIKKwAgIhggAyAIQThsaiILKwAgIhmhIhogGqIgCkEoaisAACIbIAtBKGorAAAiHKEiHSAdoqAiHkQAAAAAAAAAAGENACAaIBggGaCiIB0gGyAcoKKgIB6jIhdEAAAAAAAA8L8gF0QAAAAAAADwv2QbIhdEAAAAAAAA8D8gF0QAAAAAAADwP2MbRAAAAAAAAOC/oiEXCyAZRAAAAAAAAOA/IBehIhqiIBggF0QAAAAAAADgP6AiF6KgIhggGKIgHCAaoiAbIBeioCIXIBeioCIXIBYgFyAWYyIKGyEWIAggByAKGyEHIAkhCCAJQQFqIgkgAkcNAAsLIAZBqAJqQTBqIgkgAyAHQThsaiIIQTBqKQMANwMAIAZBqAJqQShqIgogCEEoaikDADcDACAGQagCakEgaiILIAhBIGopAwA3AwAgBkGoAmpBGGoiDCAIQRhqKQMANwMAIAZBqAJqQRBqIAhBEGopAwA3AwAgBkGoAmpBCGogCEEIaikDADcDACAGIAgpAwA3A6gCIAZB8AFqQTBqIg0gAyAHQQFqIg4gAm9BOGxqIghBMGopAwA3AwAgBkHwAWpBKGoiByAIQShqKQMANwMAIAZB8AFqQSBqIg8gCEEgaikDADcDACAGQfABakEYaiIQIAhBGGopAwA3AwAgBkHwAWpBEGogCEEQaikDADcDACAGQfABakEIaiAIQQhqKQMANwMAIAYgCCkDADcD8AEgBysDACEXIAorAwAhFiAGQeACakEIaiIIIA8rAwAgCysDAKEiGDkDACAGIBcgFqEiF5o5A+ACIAEoAgAhByABKAIIIQogBkGIA2pBCGoiCyAYmjkDACAGIBc5A4gDIAZB8ABqQQhqIAspAwA3AwAgBiAGKQOIAzcDcCAGQZgDaiAHIAZB8ABqIAoRAAAgASgCBCEHIAEoAgwhCiAGQeAAakEIaiAIKQMANwMAIAYgBikD4AI3A2AgBkHwAmogByAGQeAAaiAKEQAAIAZBuAFqQRhqIAYrA/gCIhc5AwAgBkG4AWpBKGogFyAGKwOgAyIWoTkDACAGIAYrA/ACIhc5A8gBIAYgFjkDwAEgBiAGKwOYAyIWOQO4ASAGIBcgFqE5A9gBIAYgBigCqANBCHRBgP4DcSAGLQCAA3IiCDYC6AECQAJAIAggCSgCAEYNACAIIA0oAgBGDQAgBkHQAGpBCGogBkGoAmpBKGopAwA3AwAgBkHAAGpBCGogBkHwAWpBKGopAwA3AwAgBkEwakEIaiAGQbgBakEoaikDADcDACAGIAYpA8gCNwNQIAYgBikDkAI3A0AgBiAGKQPYATcDMCAGQdAAaiAGQcAAaiAGQTBqEIABIQggBEEdSg0AIAhFDQAgBSACQThsQccAakFwcWsiDSQAIA1BMGogBkG4AWpBMGoiECkDADcDACANQShqIAZBuAFqQShqIhEpAwA3AwAgDUEgaiAGQbgBakEgaiISKQMANwMAIA1BGGogBkG4AWpBGGoiEykDADcDACANQRBqIAZBuAFqQRBqIhQpAwA3AwAgDUEIaiAGQbgBakEIaiIVKQMANwMAIA0gBikDuAE3AwBBASEMAkAgAkEBSA0AIAZBgAFqQSBqIQVBACEHQQEhDANAIAxBOGwgDWoiCEFoaiEPIAMgByAOaiACbyILQThsaiIJQSBqIQoCQAJAIAdBAWoiByACTg0AIAZBgAFqQTBqIAMgC0EBaiACb0E4bGoiC0EwaikDADcDACAGQYABakEoaiALQShqKQMANwMAIAUgC0EgaikDADcDACAGQYABakEYaiALQRhqKQMANwMAIAZBgAFqQRBqIAtBEGopAwA3AwAgBkGAAWpBCGogC0EIaikDADcDACAGIAspAwA3A4ABDAELIAZBgAFqQTBqIBApAwA3AwAgBkGAAWpBKGogESkDADcDACAFIBIpAwA3AwAgBkGAAWpBGGogEykDADcDACAGQYABakEQaiAUKQMANwMAIAZBgAFqQQhqIBUpAwA3AwAgBiAGKQO4ATcDgAELIAZBIGpBCGogD0EIaikDADcDACAGIA8pAwA3AyAgBkEQakEIaiAFQQhqKQMANwMAIAYgBSkDADcDECAGQQhqIApBCGopAwA3AwAgBiAKKQMANwMAAkAgBkEgaiAGQRBqIAYQgAFFDQAgCCAJKQMANwMAIAhBMGogCUEwaikDADcDACAIQShqIAlBKGopAwA3AwAgCEEgaiAKKQMANwMAIAhBGGogCUEYaikDADcDACAIQRBqIAlBEGopAwA3AwAgCEEIaiAJQQhqKQMANwMAIAxBAWohDAsgByACRw0ACwsgACABIAwgDSAEQQFqEGAMAQsgDCsDACEfIBArAwAhFiAGKALYAiEIIAYrA7gCISAgBisDsAIhISAGKwOoAiEiIAYvAaACIQkgBisDgAIhIyAGKwP4ASEkIAYrA/ABISVEAAAAAAAAAAAhGgJAIAYrA5ACIhsgBisDyAIiHKEiGCAYoiAGKwOYAiIdIAYrA9ACIh6hIhkgGaKgIiZEAAAAAAAAAABhDQAgGCAbIBygoiAZIB0gHqCioCAmoyIXRAAAAAAAAPC/IBdEAAAAAAAA8L9kGyIXRAAAAAAAAPA/IBdEAAAAAAAA8D9jG5ohGgsgFiAaRAAAAAAAAOA/oiInRAAAAAAAAOA/oCIXoiAfRAAAAAAAAOA/ICehIhaioCEfICMgF6IgICAWoqAhICAkIBeiICEgFqKgISEgJSAXoiAiIBaioCEiIAhBEHQgCXIhCAJAAkAgGUQAAAAAAADwPyAmn0QAAAAAAAAQAKCjIiaiIhkgHCAWoiAbIBeioCIboiAmIBiaoiIYIB4gFqIgHSAXoqAiFqKgIhdEAAAAAAAAAABlDQAgGkQAAAAAAADwv2RFDQEgGkQAAAAAAADwP2NFDQELIAAgCDYCOCAAIBc5AzAgACAZOQMgIAAgIDkDECAAICE5AwggACAiOQMAIABBKGogGDkDACAAQRhqIB85AwAMAQsgACAINgI4IAAgIDkDECAAICE5AwggACAiOQMAIABBGGogHzkDACAAIBsgG6IgFiAWoqCfIhc5AzAgAEEoaiAWRAAAAAAAAPA/IBdEAAAAAAAAEACgoyIXojkDACAAIBsgF6I5AyALIAZBsANqJAALDwACQCAARQ0AIAAQ+gELC2IAIAAgAzYCDCAAIAI2AgggACABNgIAIABCADcCNCAAQQE6ADAgAEKAgICAgICA+P8ANwMoIABC44b95qCm3K4/NwMgIABCgICAgICAgPj/ADcDGCAAQgA3AxAgAEEANgIEC0EAAkAgAUQAAAAAAAAAAGYNAEHjCUGODUHlAEEBQQFBlhdBABALEAAACyAAKAIIEKcBIAAoAgwQpwEgACABOQMgCw8AIAAgACgCACgCDBEIAAvOAQIBfwR8QQFB+AEQ/gEhBSACKwMAIQYgAisDCCEHIAMrAwAhCCADKwMIIQkgBUGUIyAAIAEQYiAFQegAaiAJOQMAIAUgCDkDYCAFQdgAaiAHOQMAIAUgBjkDUCAFQcgAaiAIIAahIgZEAAAAAAAA8D8gBiAGoiAJIAehIgYgBqKgn0QAAAAAAAAQAKCjIgeiOQMAIAUgByAGmqI5A0AgBSAEKQMANwNwIAVB+ABqIARBCGopAwA3AwAgBUIANwPYASAFQeABakIANwMAIAULswECAX8CfAJAIAAoAgBBlCNGDQBB1R5BwQxBnQFBAUEBQZEVQQAQCxAAAAsgAEHQAGogASkDADcDACAAQdgAaiABQQhqIgIpAwA3AwAgAEHIAGogAEHgAGorAAAgASsDAKEiA0QAAAAAAADwPyADIAOiIABB6ABqKwAAIAIrAwChIgMgA6Kgn0QAAAAAAAAQAKCjIgSiOQMAIAAgBCADmqI5A0AgACgCCBCnASAAKAIMEKcBC7MBAgF/A3wCQCAAKAIAQZQjRg0AQdUeQcEMQbABQQFBAUGRFUEAEAsQAAALIABB4ABqIAEpAwA3AwAgAEHoAGogAUEIaiICKQMANwMAIABEAAAAAAAA8D8gASsDACAAQdAAaisAAKEiAyADoiACKwMAIABB2ABqKwAAoSIEIASioJ9EAAAAAAAAEACgoyIFIASaojkDQCAAQcgAaiADIAWiOQMAIAAoAggQpwEgACgCDBCnAQvUBgIDfw58IAAoAggiAkGgAWorAAAhBSACQagBaisAACEGIAJBkAFqKwAAIQcgAisAgAEhCCAAQYgBaiACQYgBaisAACIJIAArAEAiCqIgAkGYAWorAAAiCyAAQcgAaisAACIMoqAiDTkDACAAIAggCqIgByAMoqAiDjkDgAEgACgCDCIDQZABaisAACEMIAMrAIABIQ8gAEGwAWogA0GIAWorAAAgACsAcCADKwAooSIQoiAAQfgAaisAACADQTBqKwAAoSIRIANBmAFqKwAAoqAiCjkDACAAIA8gEKIgESAMoqAiDDkDqAECQAJAIAwgAysAOKAgDaIgDiAKIANBwABqKwAAoKKhIhEgBSAIIAArAFAiEKIgByAAQdgAaisAACISoqCgIg8gDaIgDiAGIAkgEKIgEiALoqCgIhCioWVFDQAgAEKAgICAgICA+D83A5ABDAELAkAgESAFIAggACsAYCISoiAHIABB6ABqKwAAIgiioKAiByANoiAOIAYgCSASoiALIAiioKAiCKKhZkUNACAAQoCAgICAgID4v383A5ABIAchDyAIIRAMAQsgAEIANwOQASANIA8gDqIgECANoqAiB6IgDiARoqEhECAOIAeiIA0gEaKgIQ8LIAJBwABqIgQrAAAhDiAAIA8gAisAOKEiDTkDmAEgAEGgAWogECAOoSIOOQMAIABB0AFqIAIrAxAgAysDEKAiDyAOIA6iIAIrAyAiB6KgIAogCqIgAysDICIIoqAiEEQAAAAAAADwPyAQIA8gDSANoiAHoqAgDCAMoiAIoqAiD6JEAAAAAAAAAAAgDiANoiAHoqEgCiAMoiAIoqEiByAHoqGjIgiiOQMAIABByAFqIAggB5qiIgc5AwAgAEHAAWogBzkDACAAIA8gCKI5A7gBIAQrAAAhByADKwBAIQggACsDICABENMBIQ8CQCAMIAMrADigIA0gAisAOKChRAAAAAAAAPA/IA+hmiABoyINoiIMIAyiIAogCKAgDiAHoKEgDaIiCiAKoqAiDiAAKwMoIg0gDaJkRQ0AIA0gCkQAAAAAAADwPyAOn0QAAAAAAAAQAKCjIg6ioiEKIA0gDCAOoqIhDAsgACAMOQPoASAAQfABaiAKOQMAC98BAgd8An8gAEGwAWorAAAhAiAAQaABaisAACEDIABB4AFqKwAAIQQgACgCDCEJIAArAKgBIQUgACsAmAEhBiAAKAIIIgogCisASCAAKwDYASABoiIHIAorAxAiCKKhOQNIIApB0ABqIgAgACsAACAIIAQgAaIiAaKhOQMAIAogCisDICAHIAOiIAYgAaKhoiAKKwNwoDkDcCAJIAkrAyAgBSABoiAHIAKioaIgCSsDcKA5A3AgCUHQAGoiACABIAkrAxAiAqIgACsAAKA5AwAgCSAHIAKiIAkrAEigOQNIC4AEAgJ/C3wCQCAAKwOQASAAKwDoASAAKAIMIgIrAEggAEGwAWorAwAiBCACKwNwIgWioSAAKAIIIgMrAEggAEGgAWorAwAiBiADKwNwIgeioaGhIgggACsAuAGiIABB8AFqKwAAIAArA6gBIgkgBaIgAkHQAGorAACgIAArA5gBIgogB6IgA0HQAGorAACgoaEiByAAQcABaisAAKKgIAArA9gBIgugIgUgAEGIAWorAwAiDKIgACsDgAEiDSAAQeABaisDACIOIAggAEHIAWorAACiIAcgAEHQAWorAACioKAiB6KhokQAAAAAAAAAAGQNACAMIAUgDaIgByAMoqAgDSANoiAMIAyioKMiBaIhByANIAWiIQULAkAgBSAFoiAHIAeioCINIAArAxggAaIiDCAMomRFDQAgDCAHRAAAAAAAAPA/IA2fRAAAAAAAABAAoKMiDaKiIQcgDCAFIA2ioiEFCyAAIAc5A+ABIAAgBTkD2AEgAyADKwBQIAcgDqEiByADKwMQIgyioTkDUCADIAMrAEggDCAFIAuhIgWioTkDSCADIAMrAyAgBiAFoiAKIAeioaIgAysDcKA5A3AgAiACKwMgIAkgB6IgBSAEoqGiIAIrA3CgOQNwIAIgByACKwMQIgyiIAIrAFCgOQNQIAIgBSAMoiACKwBIoDkDSAsfAQF8IAArANgBIgEgAaIgAEHgAWorAAAiASABoqCfCycAAkAgAEUNACAAKAIQEPoBIAAoAhhBAhAeIAAoAhgQGiAAEPoBCwuLAQEDf0EAIQJBAUEcEP4BIQMCQANAIAJBAnRBsCNqKAIAIgQgAE4NASACQQFqIgJBHUcNAAtBzhBBiwlBwQBBAUEBQcQIQQAQCxAAAAsgA0EANgIMIAMgATYCCCADQQA2AgAgAyAENgIEIARBBBD+ASECIANBADYCFCADIAI2AhAgA0EAEBk2AhggAwsHACAAKAIAC9QDAQV/AkACQCAAKAIQIAEgACgCBHAiBUECdGooAgAiBkUNAANAIAIgBigCACAAKAIIEQIADQIgBigCCCIGDQALCwJAAkAgACgCFCIGRQ0AIAYoAgghBwwBC0EBQYCAAhD+ASEGIAAoAhggBhAbIAAoAhQhCEEBIQkDQCAGIAlBDGxqIgdBADYCACAHIAg2AgggByEIIAlBAWoiCUGqFUcNAAsLIAAgBzYCFCAGIAE2AgQCQCADRQ0AIAIgBCADEQIAIQQLIAYgBDYCACAGIAAoAhAgBUECdGoiBygCADYCCCAHIAY2AgAgACAAKAIAQQFqIgc2AgAgByAAKAIEIgNJDQAgA0EBaiEJQQAhBwJAA0AgB0ECdEGwI2ooAgAiAiAJTg0BIAdBAWoiB0EdRw0AC0HOEEGLCUHBAEEBQQFBxAhBABALEAAACyACQQQQ/gEhAQJAIANFDQAgACgCECEFQQAhBANAAkAgBSAEQQJ0aigCACIHRQ0AA0AgBygCCCEJIAcgASAHKAIEIAJwQQJ0aiIIKAIANgIIIAggBzYCACAJIQcgCQ0ACwsgBEEBaiIEIANHDQALCyAAKAIQEPoBIAAgAjYCBCAAIAE2AhALIAYoAgALmgEBAn9BACEDAkAgACgCECABIAAoAgRwQQJ0aiIEKAIAIgFFDQACQCACIAEoAgAgACgCCBECAA0AA0AgASIEKAIIIgFFDQIgAiABKAIAIAAoAggRAgBFDQALIARBCGohBAsgBCABKAIINgIAIAAgACgCAEF/ajYCACABIAAoAhQ2AgggASgCACEDIAAgATYCFCABQQA2AgALIAMLSgACQAJAIAAoAhAgASAAKAIEcEECdGooAgAiAUUNAANAIAIgASgCACAAKAIIEQIADQIgASgCCCIBDQALCyAAQQxqIQELIAEoAgALWQEDfwJAIAAoAgRFDQBBACEDA0ACQCAAKAIQIANBAnRqKAIAIgRFDQADQCAEKAIIIQUgBCgCACACIAERAQAgBSEEIAUNAAsLIANBAWoiAyAAKAIESQ0ACwsLmQEBBH8CQCAAKAIERQ0AQQAhAwNAAkAgACgCECADQQJ0aiIEKAIAIgVFDQADQCAFKAIIIQYCQAJAIAUoAgAgAiABEQIARQ0AIAVBCGohBAwBCyAEIAY2AgAgACAAKAIAQX9qNgIAIAUgACgCFDYCCCAAIAU2AhQgBUEANgIACyAGIQUgBg0ACwsgA0EBaiIDIAAoAgRJDQALCwtiAQF/QQFBwAEQ/gEiBEGoJCAAIAEQYiAEQcgAaiACQQhqKQMANwMAIAQgAikDADcDQCAEIAMpAwA3A1AgBEHYAGogA0EIaikDADcDACAEQgA3A6ABIARBqAFqQgA3AwAgBAsLACAAKAIAQagkRguuBAICfwh8IAAoAggiAkGQAWorAAAhBCACKwCAASEFIABB6ABqIAJBiAFqKwAAIAArAEAgAisAKKEiBqIgAEHIAGorAAAgAkEwaisAAKEiByACQZgBaisAAKKgIgg5AwAgACAFIAaiIAcgBKKgIgQ5A2AgACgCDCIDQYgBaisAACEGIANBmAFqKwAAIQcgACADKwCAASAAKwBQIAMrACihIgmiIABB2ABqKwAAIANBMGorAAChIgogA0GQAWorAACioCIFOQNwIABB+ABqIAYgCaIgCiAHoqAiBjkDACAAQZgBaiACKwMQIAMrAxCgIgogCCAIoiACKwMgIgeioCAGIAaiIAMrAyAiCaKgIgtEAAAAAAAA8D8gCyAKIAQgBKIgB6KgIAUgBaIgCaKgIgqiRAAAAAAAAAAAIAggBKIgB6KhIAYgBaIgCaKhIgcgB6KhoyIJojkDACAAQZABaiAJIAeaoiIHOQMAIABBiAFqIAc5AwAgACAKIAmiOQOAASACQcAAaisAACEHIANBwABqKwAAIQkgACsDICABENMBIQoCQCAFIAMrADigIAQgAisAOKChRAAAAAAAAPA/IAqhmiABoyIFoiIEIASiIAYgCaAgCCAHoKEgBaIiCCAIoqAiBiAAKwMoIgUgBaJkRQ0AIAUgCEQAAAAAAADwPyAGn0QAAAAAAAAQAKCjIgaioiEIIAUgBCAGoqIhBAsgACAEOQOwASAAQbgBaiAIOQMAC90BAgd8An8gAEH4AGorAAAhAiAAQegAaisAACEDIABBqAFqKwAAIQQgACgCDCEJIAArAHAhBSAAKwBgIQYgACgCCCIKIAorAEggACsAoAEgAaIiByAKKwMQIgiioTkDSCAKQdAAaiIAIAArAAAgCCAEIAGiIgGioTkDACAKIAorAyAgByADoiAGIAGioaIgCisDcKA5A3AgCSAJKwMgIAUgAaIgByACoqGiIAkrA3CgOQNwIAlB0ABqIgAgASAJKwMQIgKiIAArAACgOQMAIAkgByACoiAJKwBIoDkDSAupAwICfwl8AkAgACsAsAEgACgCDCICKwBIIABB+ABqKwMAIgQgAisDcCIFoqEgACgCCCIDKwBIIABB6ABqKwMAIgYgAysDcCIHoqGhoSIIIAArAIABoiAAQbgBaisAACAAKwNwIgkgBaIgAkHQAGorAACgIAArA2AiCiAHoiADQdAAaisAAKChoSIHIABBiAFqKwAAoqAgACsDoAEiC6AiBSAFoiAAQagBaisDACIMIAggAEGQAWorAACiIAcgAEGYAWorAACioKAiByAHoqAiCCAAKwMYIAGiIgEgAaJkRQ0AIAEgB0QAAAAAAADwPyAIn0QAAAAAAAAQAKCjIgiioiEHIAEgBSAIoqIhBQsgACAHOQOoASAAIAU5A6ABIAMgAysAUCAHIAyhIgcgAysDECIBoqE5A1AgAyADKwBIIAEgBSALoSIFoqE5A0ggAyADKwMgIAYgBaIgCiAHoqGiIAMrA3CgOQNwIAIgAisDICAJIAeiIAUgBKKhoiACKwNwoDkDcCACIAcgAisDECIBoiACKwBQoDkDUCACIAUgAaIgAisASKA5A0gLHwEBfCAAKwCgASIBIAGiIABBqAFqKwAAIgEgAaKgnwuKBAIFfwR8IwBBgAFrIgUkACAFQfAAaiACIAMQESAFQeAAakEIaiIGIAVB8ABqQQhqIgcrAwCaOQMAIAVBKGpBCGogBikDADcDACAFIAUrA3CaOQNgIAVCADcDOCAFIAUpA2A3AyggBUE4akEIaiIGRAAAAAAAAPA/IAIgAyAFQShqIAQQDzkDACAFQThqQRBqIgggBSkDcDcDACAFQThqQRhqIgkgBykDADcDACAFQThqQSBqIgcgAiADIAQQEDkDACAFQQhqIAYpAwA3AwAgBUEQaiAIKQMANwMAIAVBGGogCSkDADcDACAFQSBqIAcpAwA3AwAgBSAFKQM4NwMAIABBuCQgASAFEIIBGiAAIAI2AqgBAkACQCACQQZKDQAgACAAQbABajYCrAEMAQsgACACQQF0QSAQ/gE2AqwBCwJAIAJBAUgNAEEAIQEDQCADIAEgAmoiBkF/aiACb0EEdGoiBysDCCEKIAcrAwAhCyADIAFBBHRqIgcrAwAhDCAAKAKsASAGQQV0IgZqIgggBysDCCINOQMIIAggDDkDACAAKAKsASAGaiIGQRhqRAAAAAAAAPA/IA0gCqEiCiAKoiAMIAuhIgwgDKKgn0QAAAAAAAAQAKCjIgsgDJqiOQMAIAYgCiALojkDECABQQFqIgEgAkcNAAsLIAAgBDkDoAEgBUGAAWokACAACxQAQQFBsAQQ/gEgACABIAIgAxB6CxkAAkAgACgCqAFBB0gNACAAKAKsARD6AQsL2AMCBX8OfAJAAkAgASgCqAEiA0EBTg0ARAAAAAAAAPB/IQhEAAAAAAAA8P8hCUQAAAAAAADw/yEKRAAAAAAAAPB/IQsMAQsgASgCrAEiBCADQQV0aiEFIAIrAyghDCACKwMgIQ0gAisDGCEOIAIrAxAhDyACKwMIIRAgAisDACERRAAAAAAAAPD/IQpBACEGRAAAAAAAAPB/IQtEAAAAAAAA8H8hCEQAAAAAAADw/yEJA0AgBSAGQQV0IgdqIgIrAAAhEiACKwAIIRMgBCAHaiIHQRhqIBAgAisAECIUoiAOIAJBGGorAAAiFaKgOQMAIAcgESAUoiAPIBWioDkDECAHIAwgECASoiATIA6ioKAiFDkDCCAHIA0gESASoiATIA+ioKAiEjkDACAKIBQgCiAUZBshCiAIIBQgCCAUYxshCCAJIBIgCSASZBshCSALIBIgCyASYxshCyAGQQFqIgYgA0cNAAsLIAFByABqIgIgCSABKwOgASIUoDkDACABQcAAaiIHIAggFKE5AwAgASALIBShOQM4IAFB0ABqIgYgCiAUoDkDACAAQRBqIAIpAwA3AwAgAEEYaiAGKQMANwMAIAAgASkDODcDACAAQQhqIAcpAwA3AwAL3gQCCH8MfCMAIQMgACgCqAEiBEEFdCAAKAKsASIFakFgaiIGKwMIIQsgBisDACEMIAArA6ABIQ0gA0EQayIHQQhqIghCADcDACAHQgA3AwBBASEDAkACQCAEQQFODQBEAAAAAAAA8H8hDkQAAAAAAAAAACEPRAAAAAAAAAAAIRAMAQsgASsDCCERIAErAwAhEkEAIQlEAAAAAAAA8H8hDkEAIQZEAAAAAAAAAAAhEEQAAAAAAAAAACEPA0AgBSAGQQV0aiIDKwMIIRMgAysDACEUQQEhCgJAIAkNACADKwAQIBIgFKGiIBEgE6EgA0EYaisAAKKgRAAAAAAAAAAAZCEKCwJAIBIgFCAMIBShIgwgDCASIBShoiALIBOhIgsgESAToaKgIAwgDKIgCyALoqCjIgxEAAAAAAAA8D8gDEQAAAAAAADwP2MbRAAAAAAAAAAApSIMoqAiFaEiFiAWoiARIBMgCyAMoqAiC6EiDCAMoqCfIgwgDmNFDQAgCCADQRhqKQMANwMAIAcgAykDEDcDACAVIQ8gCyEQIAwhDgsgCiEJIBMhCyAUIQwgBkEBaiIGIARHDQALIApBAXMhAwsgASsDACETIAErAwghFCACIAA2AgAgAiAOmiAOIAMbIgwgDaE5AxggAkEQaiAQIA1EAAAAAAAA8D8gDKMiDCAUIBChoiIUoqA5AwAgAiAPIA0gDCATIA+hoiIToqA5AwgCQCAORPFo44i1+OQ+ZEUNACACIBM5AyAgAkEoaiAUOQMADwsgAiAHKQMANwMgIAJBKGogB0EIaikDADcDAAuyBwIRfAV/IAArA6ABIAOgIQUgACgCrAEhFgJAIAAoAqgBIhdBAUgNACAXQX9qIRggAisDCCEGIAIrAwAhByABKwMIIQggASsDACEJQQAhGQNAAkAgCSAWIBlBBXRqIhorAxAiCqIgGkEYaisDACILIAiioCIMIBorAAAiDSAKoiALIBorAAgiDqKgoSAFoSIPRAAAAAAAAAAAYw0AAkAgDCAHIAqiIAsgBqKgoSIMRPFo44i1+OQ+Y0UNACAMRPFo44i1+OS+ZA0BCyAPIAyjIgxEAAAAAAAAAABjDQAgDEQAAAAAAADwP2QNACAKIBYgGCAZaiAXb0EFdGoiGisACKIgGisAACALoqEgCiAGIAyiIAhEAAAAAAAA8D8gDKEiD6KgIhCiIAcgDKIgCSAPoqAiESALoqEiD2VFDQAgDyAKIA6iIA0gC6KhZUUNACAEIAw5AyggBCALOQMgIAQgCjkDGCAEIAA2AgAgBCAQIAsgA6KhOQMQIAQgESAKIAOioTkDCAsgGUEBaiIZIBdHDQALCwJAIAVEAAAAAAAAAABkRQ0AIBdBAUgNACABKwMIIRIgASsDACETIAIrAwghDSACKwMAIQ5BACEaIAWaIAWiIRQDQEQAAAAAAAAAACEHRAAAAAAAAAAAIRAgDSERIA4hFUQAAAAAAADwPyEIQQAhGQJAIBMgFiAaQQV0aiIBKwAAIguhIgogDiALoSILoiASIAErAAgiD6EiDCANIA+hIg+ioCIJIAogCqIgDCAMoqAiBaEiBiAGoiAUIAWgIAsgC6IgDyAPoqAgBSAJIAmgoaAiCaKhIgVEAAAAAAAAAABmRQ0ARAAAAAAAAAAAIQcCQCAGmiAFn6EgCaMiCUQAAAAAAAAAAGYNAEQAAAAAAAAAACEQIA0hESAOIRVEAAAAAAAA8D8hCEEAIRkMAQtEAAAAAAAAAAAhECANIREgDiEVRAAAAAAAAPA/IQhBACEZIAlEAAAAAAAA8D9lRQ0AIA0gCaIgEkQAAAAAAADwPyAJoSIIoqAgDyAJoiAMIAiioCIMRAAAAAAAAPA/IAsgCaIgCiAIoqAiCiAKoiAMIAyioJ9EAAAAAAAAEACgoyILoiIHIAOioSERIA4gCaIgEyAIoqAgCiALoiIQIAOioSEVIAkhCCAAIRkLAkAgCCAEKwMoY0UNACAEIAg5AyggBCAHOQMgIAQgEDkDGCAEIBE5AxAgBCAVOQMIIAQgGTYCAAsgGkEBaiIaIBdHDQALCwtFAQV8IAErAwgiAyAAKwMIIgShIAArAwAiBSABKwMAIgagIAIrAwAiByAHoKGiIAYgBaEgAyAEoCACKwMIIgMgA6ChomQLTAEDfCACKwMAIAMrAwAiBKIgAisDCCADKwMIIgWioCAAKwMAIASiIAUgACsDCKKgIgYgASsDACAEoiAFIAErAwiioCIEIAYgBGQbZQu1AQAgACACNgIIIAAgATYCACAAIAMpAwA3AxAgAEEYaiADQQhqKQMANwMAIABBIGogA0EQaikDADcDACAAQShqIANBGGopAwA3AwAgAEEwaiADQSBqKQMANwMAIABBADYCiAEgAEEAOgBYIABCADcDYCAAQegAakIANwMAIABB8ABqQgA3AwAgAEH4AGpCADcDACAAQYwBakJ/NwIAIABCADcDgAEgAEEANgIEIABCADcClAEgAAsvAQF/AkAgAEUNAAJAIAAoAgAiAUUNACABKAIIIgFFDQAgACABEQQACyAAEPoBCws/ACAAIAEpAzg3AwAgAEEYaiABQdAAaikDADcDACAAQRBqIAFByABqKQMANwMAIABBCGogAUHAAGopAwA3AwALOQACQCABRAAAAAAAAAAAZg0AQfUJQcAPQZsBQQFBAUGyF0EAEAsQAAALIAAoAggQpwEgACABOQNoCyYAIAAoAggQpwEgAEGQAWogAUEIaigCADYCACAAIAEpAgA3AogBC+oCAgR/Bn4jAEGAAWsiAiQAIAJBMGpBKGogASgCCCIDQagBaikAACIGNwMAIAJBMGpBIGogA0GgAWopAAAiBzcDACACQTBqQRhqIANBmAFqKQAAIgg3AwAgAkEwakEQaiADQZABaikAACIJNwMAIAJBMGpBCGogA0GIAWopAAAiCjcDACACIAMpAIABIgs3AzAgASgCACgCBCEDIAJBKGogBjcDACACQSBqIAc3AwAgAkEYaiAINwMAIAJBEGogCTcDACACQQhqIAo3AwAgAiALNwMAIAJB4ABqIAEgAiADEQAAIAFB0ABqIgMgAkHgAGpBGGopAwA3AwAgAUHIAGoiBCACQeAAakEQaikDADcDACABQcAAaiIFIAJB4ABqQQhqKQMANwMAIAEgAikDYDcDOCAAQRhqIAMpAwA3AwAgAEEQaiAEKQMANwMAIABBCGogBSkDADcDACAAIAEpAzg3AwAgAkGAAWokAAuFAgEDfyMAQdAAayIDJAAgASgCACgCBCEEIANBKGogAkEoaikDADcDACADQSBqIAJBIGopAwA3AwAgA0EYaiACQRhqKQMANwMAIANBEGogAkEQaikDADcDACADQQhqIAJBCGopAwA3AwAgAyACKQMANwMAIANBMGogASADIAQRAAAgAUHQAGoiAiADQTBqQRhqKQMANwMAIAFByABqIgQgA0EwakEQaikDADcDACABQcAAaiIFIANBMGpBCGopAwA3AwAgASADKQMwNwM4IABBGGogAikDADcDACAAQRBqIAQpAwA3AwAgAEEIaiAFKQMANwMAIAAgASkDODcDACADQdAAaiQAC50CAgN/AXwjAEEQayIDJABBAUHIARD+ASIEQagBaiACQQhqIgUpAwA3AwAgBCACKQMANwOgASAEIAE5A8ABIANBCGpCADcDACADQgA3AwBEAAAAAAAA8D9EAAAAAAAAAAAgASADEAwhBkQAAAAAAAAAACABEA0hASAEQRhqIAY5AwAgBEIANwMQIAQgADYCCCAEQcwkNgIAIARBIGogAikDADcDACAEQShqIAUpAwA3AwAgBEEANgKIASAEQQA6AFggBEEwaiABOQMAIARCADcDYCAEQegAakIANwMAIARB8ABqQgA3AwAgBEH4AGpCADcDACAEQYwBakJ/NwIAIARCADcDgAEgBEIANwKUASAEQQA2AgQgA0EQaiQAIAQL0wQCAn8HfCMAQcAAayIEJABBAUGoAhD+ASEFIAErAwAhBiABKwMIIQcgAisDACEIIAIrAwghCSAFQgA3A4gCIAUgAzkDgAIgBUG4AWogCTkDACAFIAg5A7ABIAVBqAFqIAc5AwAgBSAGOQOgASAFQZACakIANwMAIAVBmAJqQgA3AwAgBUGgAmpCADcDACAFQcgBakQAAAAAAADwPyAIIAahIgogCqIgCSAHoSILIAuioJ9EAAAAAAAAEACgoyIMIAqaojkDACAFIAsgDKI5A8ABIARBIGpBCGoiAiAHOQMAIARBMGpBCGoiASAJOQMAIAQgBjkDICAEIAg5AzBEAAAAAAAA8D8gAyADoCIKIAYgCKEiBiAGoiAHIAmhIgYgBqKgn6AgChASIQYgBEEQakEIaiACKQMANwMAIARBCGogASkDADcDACAEIAQpAyA3AxAgBCAEKQMwNwMAIAErAwAhByACKwMAIQggBCsDMCEJIAQrAyAhCiAEQRBqIAQgAxAOIQMgBUEANgKIASAFQQA6AFggBUEwaiADOQMAIAVBKGogB0QAAAAAAADgP6IgCEQAAAAAAADgP6KgOQMAIAVBIGogCUQAAAAAAADgP6IgCkQAAAAAAADgP6KgOQMAIAVBGGogBjkDACAFQgA3AxAgBSAANgIIIAVB4CQ2AgAgBUIANwNgIAVB6ABqQgA3AwAgBUHwAGpCADcDACAFQfgAakIANwMAIAVBjAFqQn83AgAgBUIANwOAASAFQgA3ApQBIAVBADYCBCAEQcAAaiQAIAULjgEBBnwgAisDICEDIAIrAxAhBCACKwMAIQUgAUG4AWogAisDKCACKwMIIAErAKABIgaiIAFBqAFqKwAAIgcgAisDGKKgoCIIOQMAIAEgAyAFIAaiIAcgBKKgoCIEOQOwASAAIAggASsDwAEiA6A5AxggACAEIAOgOQMQIAAgCCADoTkDCCAAIAQgA6E5AwAL8gECAX8IfCAAQbgBaiIDKwAAIQQgACsDwAEhBSABKwMIIQYgASsDACEHIAArALABIQggAiAANgIAIAMrAAAhCSAAKwCwASEKIAIgByAIoSIHIAeiIAYgBKEiBiAGoqCfIgQgBaE5AxhEAAAAAAAAAAAhCEQAAAAAAADwPyELIAJBEGogCSAGIAUgBEQAAAAAAADwPyAERAAAAAAAAAAAZBujIgWioDkDACACIAogByAFoqA5AwgCQCAERPFo44i1+OQ+ZEUNACAGRAAAAAAAAPA/IASjIgSiIQsgByAEoiEICyACIAg5AyAgAkEoaiALOQMAC9gCAQx8AkAgASsDACIFIAArALABIgahIgcgAisDACIIIAahIgaiIAErAwgiCSAAQbgBaisAACIKoSILIAIrAwgiDCAKoSIKoqAiDSAHIAeiIAsgC6KgIg6hIg8gD6IgDiAAKwPAASADoCIQIBCioSAGIAaiIAogCqKgIA4gDSANoKGgIg2ioSIORAAAAAAAAAAAZkUNACAPmiAOn6EgDaMiDUQAAAAAAAAAAGZFDQAgDUQAAAAAAADwP2VFDQAgBCANOQMoIAQgADYCACAEQSBqIAogDaIgC0QAAAAAAADwPyANoSIKoqAiC0QAAAAAAADwPyAGIA2iIAcgCqKgIgcgB6IgCyALoqCfRAAAAAAAABAAoKMiBqIiCzkDACAEIAcgBqIiBzkDGCAEQRBqIAwgDaIgCSAKoqAgCyADoqE5AwAgBCAIIA2iIAUgCqKgIAcgA6KhOQMICwumAgEJfCACKwMgIQMgAisDKCEEIAIrAxAhBSACKwMAIQYgAUH4AWogAisDCCIHIAErAMABIgiiIAIrAxgiCSABQcgBaisAACIKoqA5AwAgASAGIAiiIAUgCqKgOQPwASABQdgBaiAEIAcgASsAoAEiCqIgCSABQagBaisAACILoqCgIgg5AwAgASADIAYgCqIgCyAFoqCgIgo5A9ABIAFB6AFqIAQgByABKwCwASILoiAJIAFBuAFqKwAAIgeioKAiBDkDACABIAMgBiALoiAFIAeioKAiBTkD4AEgACAEIAggCCAEYyICGyABKwOAAiIGoDkDGCAAIAYgBSAKIAogBWMiARugOQMQIAAgCCAEIAIbIAahOQMIIAAgCiAFIAEbIAahOQMAC9cCAQh8IABB2AFqKwAAIQMgAEHoAWorAAAhBCAAKwOAAiEFIAErAwghBiAAKwDQASEHIAErAwAhCCAAKwDgASEJIAIgADYCACACIAggCSAHIAmhIgcgByAIIAmhoiADIAShIgMgBiAEoaKgIAcgB6IgAyADoqCjIgdEAAAAAAAA8D8gB0QAAAAAAADwP2MbRAAAAAAAAAAApSIHoqAiCqEiCSAJoiAGIAQgAyAHoqAiA6EiByAHoqCfIgQgBaE5AxggAkEQaiADIAUgB0QAAAAAAADwPyAEoyIGoiIHokQAAAAAAAAAgCAERAAAAAAAAAAAYiIBG6A5AwAgAiAKIAUgCSAGoiIJokQAAAAAAAAAgCABG6A5AwgCQCAERPFo44i1+OQ+ZEUNACACIAk5AyAgAkEoaiAHOQMADwsgAiAAKQPAATcDICACQShqIABByAFqKQMANwMAC+cIARV8AkACQAJAIAIrAwAiBSABKwMAIgahIgcgAEHYAWorAAAiCCAAKwOAAiADoCIJIABB+AFqKwMAIgqaIAogACsA0AEiCyAGoSAAKwPwASIMoiAKIAggASsDCCINoaKgIg5EAAAAAAAAAABkIgEbIg+iIA2hIhCgoiALIAkgDJogDCABGyIRoiAGoSISoCACKwMIIhMgDaEiFKKhIAcgAEHoAWorAAAiFSAQoKIgACsA4AEiECASoCAUoqGiRAAAAAAAAAAAZUUNACAHIAyiIAogFKKgIA4gCZogCSABG6AiCaEiCiAJmiIJokQAAAAAAAAAAGNFDQIgBCAANgIAIBMgCSAJIAqhoyIKoiANRAAAAAAAAPA/IAqhIgmioCAPIAOioSEMIAUgCqIgBiAJoqAgESADoqEhBwwBCyAJRAAAAAAAAAAAYQ0BRAAAAAAAAAAAIRYgCZohF0QAAAAAAADwPyEKRAAAAAAAAAAAIQ9EAAAAAAAAAAAhESATIQwgBSEHQQAhAgJAIAYgC6EiFCAFIAuhIguiIA0gCKEiEiATIAihIgiioCIOIBQgFKIgEiASoqAiGKEiGSAZoiAYIAkgCaKhIAsgC6IgCCAIoqAgGCAOIA6goaAiDqKhIhhEAAAAAAAAAABmRQ0ARAAAAAAAAAAAIQ8CQCAZmiAYn6EgDqMiDkQAAAAAAAAAAGYNAEQAAAAAAADwPyEKRAAAAAAAAAAAIREgEyEMIAUhB0EAIQIMAQtEAAAAAAAA8D8hCkQAAAAAAAAAACERIBMhDCAFIQdBACECIA5EAAAAAAAA8D9lRQ0AIBMgDqIgDUQAAAAAAADwPyAOoSIKoqAgCCAOoiASIAqioCIMRAAAAAAAAPA/IAsgDqIgFCAKoqAiCCAIoiAMIAyioJ9EAAAAAAAAEACgoyILoiIPIAOioSEMIAUgDqIgBiAKoqAgCCALoiIRIAOioSEHIA4hCiAAIQILAkACQCAGIBChIgggBSAQoSILoiANIBWhIhQgEyAVoSIQoqAiEiAIIAiiIBQgFKKgIhWhIg4gDqIgFyAJoiAVoCALIAuiIBAgEKKgIBUgEiASoKGgIgmioSISRAAAAAAAAAAAZkUNAEQAAAAAAAAAACEWIA6aIBKfoSAJoyIJRAAAAAAAAAAAZkUNACAJRAAAAAAAAPA/ZUUNACATIAmiIA1EAAAAAAAA8D8gCaEiEqKgIBAgCaIgFCASoqAiDUQAAAAAAADwPyALIAmiIAggEqKgIgggCKIgDSANoqCfRAAAAAAAABAAoKMiDaIiFiADoqEhEyAFIAmiIAYgEqKgIAggDaIiBiADoqEhBQwBC0QAAAAAAADwPyEJRAAAAAAAAAAAIQZBACEACwJAIAogCWNFDQAgBCACNgIADAELIAQgADYCACAFIQcgEyEMIAYhESAWIQ8gCSEKCyAEIAo5AyggBCAROQMYIAQgBzkDCCAEQSBqIA85AwAgBEEQaiAMOQMACwsCAAvUAwECfyAAQgA3AwggAEEKNgIAIABBADYCjAEgAEEDNgJAIABC44b95qCm3K4/NwM4IABCgICAgJqz5tw/NwMwIABCgICAgICAgPg/NwMYIABBADYCaCAAQQA2AkggAEEQakIANwMAIABBMEEAECIiATYCbCAAQTAgARAiIgE2AnAgAUExECEgAEEAEBk2AogBIABBABAZNgJYIABBABAZNgJcIABBABAZNgJkQQAQGSEBIABCgICAgICAgPj/ADcDKCAAIAE2AmAgAEIANwMgIABBABAZNgJ4QQAQGSEBIABBADYCfCAAIAE2AoQBIABBAEEyEG02AoABIABBABAZNgJ0IABBACkC7HA3ApQBIABBnAFqQezwAEEIaikCADcCACAAQaQBakHs8ABBEGopAgA3AgAgAEGsAWpB7PAAQRhqKAIANgIAIABBAEEzEG02ApABQQAQGSEBIABBADoAsAEgACABNgK0ASAAQcABakQAAAAAAAAAAEQAAAAAAAAAABA5IgFBAhBAAkACQCAAKAK4ASICRQ0AIAIoAtQBDQEgAkEANgLQAQsgACABNgK4ASABIAA2AtABIAAPC0GhEUGHEEHLAkEBQQFB0x1BABALEAAACyIAIAAgASgCCCIBKQNINwMAIABBCGogAUHQAGopAwA3AwALRgEDfyAAKAIEIQICQCAAKAIAIgMgASgCJCIERw0AIAIgASgCKEcNAEEBDwtBACEAAkAgAiAERw0AIAMgASgCKEYhAAsgAAsnAQF/QQAhAgJAIAAoAgAgASgCAEcNACAAKAIEIAEoAgRGIQILIAILDQBBAUGwAxD+ARCSAQv7AgEEfyAAEKwBAkAgACgCWCIBKAIAQQFIDQBBACECA0AgASgCCCACQQJ0aigCABCnASACQQFqIgIgASgCAEgNAAsLAkAgACgCXCIBKAIAQQFIDQBBACECA0AgASgCCCACQQJ0aigCABCnASACQQFqIgIgASgCAEgNAAsLAkAgACgCZCIDKAIAQQFIDQBBACEEA0ACQCADKAIIIARBAnRqKAIAIgJFDQADQCACQeQBaigCACEBIAIQpwEgASECIAENAAsLIARBAWoiBCADKAIASA0ACwsgAEEBEK0BIAAoAmwQtgEgACgCcBC2ASAAKAJYEBogACgCXBAaIAAoAmQQGiAAKAJgEBogACgCdBAaIAAoAoABEGwgACgCeBAaIAAoAoQBEBoCQCAAKAKIASICRQ0AIAJBAhAeIAAoAogBEBoLAkAgACgCtAEiAkUNACACQQIQHiAAKAK0ARAaCwJAIAAoApABIgJFDQAgAkE0QQAQcgsgACgCkAEQbAsHACAAEPoBCxQAAkAgAEUNACAAEJcBIAAQ+gELCyoAAkAgAUEASg0AQbgSQYcQQdABQQFBAUHqFUEAEAsQAAALIAAgATYCAAtVACAAIAEpAwA3AwggAEEQaiABQQhqKQMANwMAAkAgACgCZCIBKAIAQQFIDQBBACEAA0AgASgCCCAAQQJ0aigCABCnASAAQQFqIgAgASgCAEgNAAsLCwkAIAAgATkDMAsJACAAIAE5AzgLCAAgACgCuAELjwMBBH8jAEHQAGsiAiQAAkACQAJAAkACQCABKAIEIgMgAEYNACADDQEgASgCCCIDRQ0CIAMoAtABIABHDQMgACgCjAENBAJAIAMQREECRiIEDQAgAxCnAQsgAyABEEggACAAKAJoIgVBAWo2AmggASAFNgKcASACQQhqIANBiAFqKQMANwMAIAJBEGogA0GQAWopAwA3AwAgAkEYaiADQZgBaikDADcDACACQSBqIANBoAFqKQMANwMAIAJBKGogA0GoAWopAwA3AwAgAiADKQOAATcDACACQTBqIAEgAhCIASAAQewAQfAAIAQbaigCACIDIAEgASgCnAEgAygCACgCEBEAACABIAA2AgQgAkHQAGokACABDwtBiAtBhxBB+AJBAUEBQf0ZQQAQCxAAAAtBrgpBhxBB+QJBAUEBQbMcQQAQCxAAAAtBgAhBhxBB+gJBAUEBQbIdQQAQCxAAAAtBvApBhxBB+wJBAUEBQZMYQQAQCxAAAAtBngtBhxBB/AJBAUEBQZQWQQAQCxAAAAuOAQEBfwJAAkACQCABKALQASICIABGDQAgAg0BIAAoAowBDQIgAEHcAEHYACABEERBAkYbaigCACABEBsgASAANgLQASABDwtB2ApBhxBBjwNBAUEBQdEYQQAQCxAAAAtBjgpBhxBBkANBAUEBQYkbQQAQCxAAAAtBngtBhxBBkQNBAUEBQZQWQQAQCxAAAAvbAQECfwJAAkACQAJAIAEoAgQiAiAARg0AIAINASAAKAKMAQ0CIAEoAggiAkUNAyABKAIMIgNFDQMgAhCnASADEKcBIAAoAnQgARAbIAEgAigC3AE2AhAgAiABNgLcASABIAMoAtwBNgIUIAMgATYC3AEgASAANgIEIAEPC0HtCkGHEEGcA0EBQQFBpBlBABALEAAAC0GbCkGHEEGdA0EBQQFB2xtBABALEAAAC0GeC0GHEEGeA0EBQQFBlBZBABALEAAAC0HGEUGHEEGhA0EBQQFBhhRBABALEAAAC4MCAQR/IwBBIGsiAiQAIAEoAgghAwJAAkACQCABKAIEIgQgACgCLEcNACADRQ0BIAMgACgCJEYNAQtBASEFIAQgACgCMEcNASADRQ0AIAMgACgCKEcNAQsCQCADRQ0AIAAoAnhBA0YNACAAQQQ2AnggAiAAKAJgNgIAIAIgACgCZDYCBCACIAAoAmg2AgggAiAAKAJsNgIMIAIgASgCAEGUAWo2AhBBACEDA0AgACABKAIAIAIgA0ECdGooAgAiBSgCGCAFKAIUEQAAIANBAWoiA0EFRw0ACwsgABATIAEoAgAoAnggABAdIAEoAgAoAoQBIAAQG0EAIQULIAJBIGokACAFC+gBAQN/IwBBEGsiAiQAAkACQCABKAIEIABHDQAgACgCjAENAQJAAkAgASgCCCIDEEQiBEECRw0AIAMgARCoAQwBCyADEKcBCyADIAEQSSAAEKwBIAIgATYCCCACIAM2AgQgAiAANgIAIAAoAoABQTUgAhBzIABBARCtASAAQewAQfAAIARBAkYbaigCACIAIAEgASgCnAEgACgCACgCFBEAACABQQA2ApwBIAFBADYCBCACQRBqJAAPC0GvH0GHEEHkA0EBQQFBliFBABALEAAAC0GeC0GHEEHlA0EBQQFBlBZBABALEAAAC5QBAAJAAkACQCAAKAK4ASABRg0AIAEoAtABIABHDQEgACgCjAENAiABEKcBIABB3ABB2AAgARBEQQJGG2ooAgAgARAdIAFBADYC0AEPC0HSH0GHEEH4A0EBQQFB0RpBABALEAAAC0G0HkGHEEH5A0EBQQFB9h9BABALEAAAC0GeC0GHEEH8A0EBQQFBlBZBABALEAAAC3sAAkACQCABKAIEIABHDQAgACgCjAENASABKAIIEKcBIAEoAgwQpwEgACgCdCABEB0gASgCCCABEEogASgCDCABEEogAUEANgIEDwtB+x5BhxBBhwRBAUEBQcMgQQAQCxAAAAtBngtBhxBBiARBAUEBQZQWQQAQCxAAAAvGAwEFfyMAQRBrIgIkAAJAAkACQAJAIAEQRA0AAkAgACgCjAFFDQAgACgCYCABEB8NBCAAKAJgIAEQGwwECyAAKAJYIAEQGyABKALUASIDDQEMAgtBjBJB2g1BIEEBQQFByxNBABALEAAACwNAIAAoAmwiBCADIAMoApwBIAQoAgAoAhQRAAAgACgCcCIEIAMgAygCnAEgBCgCACgCEBEAACADKAKUASIDDQALCwJAIAEoAtgBIgNFDQADQAJAAkAgAygCLCIEIAFGDQAgBBBEQQJHDQELIAMoAkghBCADKAJEIQUgAyAAEK8BIgY2AkggBiAEIAVB4ABsEL8BGiAAIAUQsAEgAygCJCEFIAIgAygCKCIGNgIMIAIgBTYCCCAAKAKAASAGQeHj/bp8bCAFQeHj/bp8bHMgAkEIakEAIAMQbxogAyAAKAJINgJ0IAAoAnggAxAbIAQQ+gELIANBNEE8IAMoAiwgAUYbaigCACIDDQALCyABKALcASIDRQ0AA0ACQAJAIAMoAggiBCABRg0AIAQQREECRw0BCyAAKAJ0IAMQGwsgA0EQQRQgAygCCCABRhtqKAIAIgMNAAsLIAJBEGokAAvJAQEEfwJAIABFDQAgABBEDQAgAEHoAWpCADcDAAJAIAAoAuABIgFFDQAgARBDRQ0AIAEoAtABIQIgASEDA0AgA0HoAWpCADcDACADQeQBaigCACEEIANCADcD4AEgAiADEKYBIAQhAyAEDQALIAIoAmQgARAdCyAAKALYASIDRQ0AA0ACQCADKAIsIgQgAEcNACADKAIwIQQLAkAgBBBEQQJGDQAgBEHoAWpCADcDAAsgA0E0QTwgAygCLCAARhtqKAIAIgMNAAsLC4oBAQJ/AkAgABBEQQJHDQACQCAAKALYASICRQ0AA0ACQAJAIAFFDQAgAigCJCABRg0AIAIoAiggAUcNAQsCQCACKAIsIgMgAEcNACACKAIwIQMLIAMQpwELIAJBNEE8IAIoAiwgAEYbaigCACICDQALCw8LQeERQdoNQZ8BQQFBAUHaEkEAEAsQAAALwQYCC38EfCAAKAJYIQICQCAAKwMoIg1EAAAAAAAA8H9hDQACQAJAIAArAyAiDkQAAAAAAAAAAGENACAOIA6iIQ8MAQsgACsACCIOIA6iIABBEGorAAAiDiAOoqAgAaIgAaIhDwsgAigCAEEBSA0AQQAhAwNAAkAgAigCCCADQQJ0aigCACIEEEQNAEQAAAAAAAAAACEQRAAAAAAAAAAAIQ4CQCAPRAAAAAAAAAAAYQ0AIA8gBCsDCKIhDgsCQCAEEFEgDmQNACAEQegBaisDACABoCEQCyAEQegBaiAQOQMACyADQQFqIgMgAigCAEgNAAsLAkAgACgCeCIFKAIAIgZBAUgNAEEAIQcDQCAFKAIIIAdBAnRqKAIAIgMoAjAhBCADKAIsIQgCQCANRAAAAAAAAPB/YQ0AAkACQCAEEERBAUYNACAIEENFDQELIAgQpwELAkAgCBBEQQFGDQAgBBBDRQ0BCyAEEKcBCyADQTRqIgkgA0E8aiIKIAMoAiwiCyAIRhsgCCgC2AEiDDYCAAJAIAxFDQAgDEE0QTwgDCgCLCAIRhtqIAM2AgQLIAggAzYC2AEgCSAKIAsgBEYbIAQoAtgBIgg2AgACQCAIRQ0AIAhBNEE8IAgoAiwgBEYbaiADNgIECyAEIAM2AtgBIAdBAWoiByAGRw0ACwsCQCANRAAAAAAAAPB/YQ0AAkAgACgCdCIIKAIAQQFIDQBBACEDA0AgCCgCCCADQQJ0aigCACIMKAIIIQQCQCAMKAIMIgwQREEBRw0AIAQQpwELAkAgBBBEQQFHDQAgDBCnAQsgA0EBaiIDIAgoAgBIDQALCyACKAIAQQFIDQBBACEIA0BBACEEAkAgAigCCCAIQQJ0aigCACIDRQ0AIAMoAuABIQQLAkACQCAEDQAgA0UhDCADIAMQqgECQCADRQ0AIAMhBCADKwPoASAAKwMoIg1jDQADQCAEQeQBaigCACIERSEMIARFDQEgBEHoAWorAwAgDWNFDQALCyAMRQ0AIAAoAmQgAxAbIANFDQEDQCAAIAMQqwEgA0HkAWooAgAiAw0ADAILAAsgA0IANwPgASAIQQFqIQgLIAggAigCAEgNAAsLC9EBAQJ/AkAgARBEDQACQCABRQ0AIAEoAuABDQELIAEgADYC4AECQCABIABGDQAgAUHkAWogAEHkAWoiAigCADYCACACIAE2AgALAkAgASgC2AEiAkUNAANAAkAgAigCLCIDIAFHDQAgAigCMCEDCyAAIAMQqgEgAkE0QTwgAigCLCABRhtqKAIAIgINAAsLIAEoAtwBIgJFDQADQAJAIAIoAggiAyABRw0AIAIoAgwhAwsgACADEKoBIAJBEEEUIAIoAgggAUYbaigCACICDQALCwuCAwEEfyMAQRBrIgIkAAJAAkACQCABEEQNACAAKAJYIAEQHSABKALUASIDDQEMAgtBjBJB2g1B1gBBAUEBQY4TQQAQCxAAAAsDQCAAKAJwIgQgAyADKAKcASAEKAIAKAIUEQAAIAAoAmwiBCADIAMoApwBIAQoAgAoAhARAAAgAygClAEiAw0ACwsCQCABKALYASIDRQ0AA0ACQAJAIAMoAiwiBCABRg0AIAQQREECRw0BCyADKAIkIQQgAiADKAIoIgU2AgwgAiAENgIIIAAoAoABIAVB4eP9unxsIARB4eP9unxscyACQQhqEHAaIAAoAnggAxAdIANBASADKAJEQeAAbCIEEP4BIAMoAkggBBC/ATYCSAsgA0E0QTwgAygCLCABRhtqKAIAIgMNAAsLAkAgASgC3AEiA0UNAANAAkACQCADKAIIIgQgAUYNACAEEERBAkcNAQsgACgCdCADEB0LIANBEEEUIAMoAgggAUYbaigCACIDDQALCyACQRBqJAALEQAgACAAKAKMAUEBajYCjAELrgIBBH8gACAAKAKMASICQX9qIgM2AowBAkAgAkEATA0AAkAgAw0AAkAgACgCYCIDKAIAIgRBAUgNAEEAIQIDQCAAIAMoAgggAkECdCIFaigCABCmASADKAIIIAVqQQA2AgAgAkEBaiICIARHDQALCyADQQA2AgAgAUUNACAAKAKMAQ0AIAAtALABDQAgAEEBOgCwAQJAIAAoArQBIgMoAgBBAUgNAEEAIQUDQCADKAIIIAVBAnQiAWooAgAiAigCACEEIAJBADYCAAJAIARFDQAgACACKAIEIAIoAgggBBEAAAsgAygCCCABakEANgIAIAIQ+gEgBUEBaiIFIAMoAgBIDQALCyADQQA2AgAgAEEAOgCwAQsPC0HHEkGqDkHJAEEBQQFB6xRBABALEAAAC9ABAQN/IAAoAkghAQJAIAAoAnwiAg0AQQFB8P8BEP4BIQMgACgCiAEgAxAbIANBADYCCCADIAE2AgAgAyADNgIEIAAgAzYCfA8LAkAgASACKAIEIgMoAgBrIAAoAkBNDQAgAyABNgIAIAMhAQJAIANFDQAgAygCBCEBCyADQQA2AgggAyABNgIEIAAgAzYCfA8LQQFB8P8BEP4BIQMgACgCiAEgAxAbIAMgATYCACACKAIEIQEgA0EANgIIIAMgATYCBCACIAM2AgQgACADNgJ8CzAAAkAgACgCfCgCCEGsfWpBqX1LDQAgABCuAQsgACgCfCIAIAAoAghB4ABsakEQags1AAJAIAFBA0gNAEH4EEGqDkGxAUEBQQFB5CFBABALEAAACyAAKAJ8IgAgACgCCCABajYCCAuVBwEFfyMAQdAAayIEJAACQAJAIAArADggAUHIAGorAABlRQ0AIAErADggAEHIAGorAABlRQ0AIABBwABqKwAAIAFB0ABqKwAAZUUNACABQcAAaisAACAAQdAAaisAAGVFDQAgACgCCCIFIAEoAggiBkYNACAAKACIASIHQQBHIAcgASgAiAFGcQ0AIABBjAFqKAAAIAFBkAFqKAAAcUUNACABQYwBaigAACAAQZABaigAAHFFDQACQCAFKALcASIHRQ0AA0ACQCAHLQAwDQACQCAHKAIIIgggBUcNACAHKAIMIAZGDQQLIAggBkcNACAHKAIMIAVGDQMLIAdBEEEUIAcoAgggBUYbaigCACIHDQALCwJAIAMoAnwoAghBrH1qQal9Sw0AIAMQrgELIARBKGogACABIAIgAygCfCIHIAcoAghB4ABsakEQahBSAkAgBCgCSCIHRQ0AIAdBA04NAiADKAJ8IgIgAigCCCAHajYCCCAEIAQoAigiBzYCICAEIAQoAiwiAjYCJCADKAKAASACQeHj/bp8bCAHQeHj/bp8bHMgBEEgakE3IAMQbyIHIARBKGogAxAVIAQgBygCYDYCACAEIAcoAmQ2AgQgBCAHKAJoNgIIIAcoAmwhAiAEIANBlAFqNgIQIAQgAjYCDAJAIAcoAngNAEEAIQIDQAJAAkAgAkEBcQ0AIAcgAyAEIAJBAnRqKAIAIgUoAhggBSgCCBEAAAwBCyAHIActAHBFOgBwIAcgAyAEIAJBAnRqKAIAIgUoAhggBSgCCBEAACAHIActAHBFOgBwCyACQQFqIgJBBUcNAAsLQQAhAgNAAkACQCACQQFxDQAgByADIAQgAkECdGooAgAiBSgCGCAFKAIMEQAADAELIAcgBy0AcEU6AHAgByADIAQgAkECdGooAgAiBSgCGCAFKAIMEQAAIAcgBy0AcEU6AHALIAJBAWoiAkEFRw0ACwJAAkAgBygCeEECRiICDQAgBy0AfEUNACAALQBYDQAgAS0AWA0AAkAgACgCCCsDCEQAAAAAAADwf2INACABKAIIKwMIRAAAAAAAAPB/YQ0BCyADKAJ4IAcQGwwBCyADKAJ8IgAgACgCCCAEKAJIazYCCCAHQgA3AkQgAg0AIAdBATYCeAsgByADKAJINgJ0CyAEKAIwIQILIARB0ABqJAAgAg8LQfgQQaoOQbEBQQFBAUHkIUEAEAsQAAALXwECfwJAIAEoAoQBKAIADQBBAUGAgAIQ/gEhAiABKAKIASACEBtBACEDA0AgASgChAEgAiADQQd0ahAbIANBAWoiA0GAAkcNAAsLIAEoAoQBEBwgACgCACAAKAIEEBQLxAIBBX8jAEEgayICJAAgACgCdCEDIAEoAkghBCAAKAIwIQUCQAJAAkAgACgCLCIGEERBAkYNACAGEENFDQELQQEhBiAFEERBAkYNASAFEEMNAQsCQCAEIANrIgNFDQAgACgCeEEDRg0AIABBAzYCeCACIAAoAmA2AgAgAiAAKAJkNgIEIAIgACgCaDYCCCAAKAJsIQYgAiABQZQBajYCECACIAY2AgxBACEGA0ACQAJAIAZBAXENACAAIAEgAiAGQQJ0aigCACIFKAIYIAUoAhQRAAAMAQsgACAALQBwRToAcCAAIAEgAiAGQQJ0aigCACIFKAIYIAUoAhQRAAAgACAALQBwRToAcAsgBkEBaiIGQQVHDQALC0EBIQYgAyABKAJASQ0AIABCADcCRCABKAKEASAAEBtBACEGCyACQSBqJAAgBgsbAQF/IwBBIGsiAiQAIAIgABCHASACQSBqJAAL8QoCCH8DfCMAQcAAayICJAACQAJAIAFEAAAAAAAAAABhDQAgACsDUCEKIAAgATkDUCAAIAAoAkhBAWo2AkggACgCdCEDIAAoAlghBAJAIAAoAngiBSgCAEEBSA0AQQAhBgNAIAUoAgggBkECdGooAgAiB0EBNgJ4AkAgBygCLBBDDQAgBygCMBBDDQAgBxATCyAGQQFqIgYgBSgCAEgNAAsLIAVBADYCACAAIAAoAowBQQFqNgKMAQJAIAQoAgBBAUgNAEEAIQYDQCAEKAIIIAZBAnRqKAIAIgcgASAHKAIEEQYAIAZBAWoiBiAEKAIASA0ACwsgABCuASAAKAJwIgZBOEEAIAYoAgAoAggRAAAgACgCcCIGQTkgACAGKAIAKAIgEQAAIAAgACgCjAEiBkF/aiIHNgKMASAGQQBMDQECQCAHDQACQCAAKAJgIgcoAgAiCEEBSA0AQQAhBgNAIAAgBygCCCAGQQJ0IglqKAIAEKYBIAcoAgggCWpBADYCACAGQQFqIgYgCEcNAAsLIAdBADYCAAsgACABEKkBIAAgACgCjAFBAWo2AowBIAAoAoABQTogABBzIAArAzggARDTASELAkAgBSgCAEEBSA0ARAAAAAAAAPA/IAuhIQsgACsDMCEMQQAhBgNAIAUoAgggBkECdGooAgAgASAMIAsQFiAGQQFqIgYgBSgCAEgNAAsLAkAgAygCAEEBSA0AQQAhBwNAAkAgAygCCCAHQQJ0aigCACIGKAI0IglFDQAgBiAAIAkRAQALIAYgASAGKAIAKAIAEQYAIAdBAWoiByADKAIASA0ACwsgACsDGCELIAJBMGpBCGoiCCAAQRBqKQMANwMAIAIgACkDCDcDMCAEKAIAIQYgCyABENMBIQsCQCAGQQFIDQBBACEGA0AgBCgCCCAGQQJ0aigCACIHKAIAIQkgAkEIaiAIKQMANwMAIAIgAikDMDcDACAHIAIgCyABIAkREwAgBkEBaiIGIAQoAgBIDQALC0QAAAAAAAAAACABIAqjIApEAAAAAAAAAABhGyELAkAgBSgCAEEBSA0AQQAhBANAIAUoAgggBEECdGooAgAgCxAXIARBAWoiBCAFKAIASA0ACwsCQCADKAIAQQFIDQBBACEEA0AgAygCCCAEQQJ0aigCACIGIAsgBigCACgCBBEGACAEQQFqIgQgAygCAEgNAAsLAkAgACgCAEEBSA0AQQAhBwNAQQAhBAJAIAUoAgBBAEwNAANAIAUoAgggBEECdGooAgAQGCAEQQFqIgQgBSgCAEgNAAsLQQAhBAJAIAMoAgBBAEwNAANAIAMoAgggBEECdGooAgAiBiABIAYoAgAoAggRBgAgBEEBaiIEIAMoAgBIDQALCyAHQQFqIgcgACgCAEgNAAsLAkAgAygCAEEBSA0AQQAhBANAAkAgAygCCCAEQQJ0aigCACIGKAI4IgdFDQAgBiAAIAcRAQALIARBAWoiBCADKAIASA0ACwsCQCAFKAIAQQFIDQAgAEGUAWohCUEAIQcDQCACIAUoAgggB0ECdGooAgAiAygCYDYCECACIAMoAmQ2AhQgAiADKAJoNgIYIAMoAmwhBCACIAk2AiAgAiAENgIcQQAhBANAAkACQCAEQQFxDQAgAyAAIAJBEGogBEECdGooAgAiBigCGCAGKAIQEQAADAELIAMgAy0AcEU6AHAgAyAAIAJBEGogBEECdGooAgAiBigCGCAGKAIQEQAAIAMgAy0AcEU6AHALIARBAWoiBEEFRw0ACyAHQQFqIgcgBSgCAEgNAAsLIABBARCtAQsgAkHAAGokAA8LQccSQaoOQckAQQFBAUHrFEEAEAsQAAALKAEBfwJAIABFDQACQCAAKAIAIgFFDQAgACABKAIAEQQACyAAEPoBCwtJACAAIAM2AgggACACNgIEIAAgATYCAAJAAkAgA0UNACADKAIMDQEgAyAANgIMCyAADwtBjAhB8wtBKkEBQQFBrRRBABALEAAAC2IBAn8jAEEQayIEJAACQCABRQ0AIAEgASgCACgCBBEDAEEBSA0AIAAoAgQhBSAEIAM2AgwgBCACNgIIIAQgATYCBCAEIAU2AgAgAEE7IAQgACgCACgCCBEAAAsgBEEQaiQAC5YBAQR/IwBBwABrIgIkACABKAIEIQMgAkEgaiAAIAEoAgARAQAgASgCDCEEIAEoAgghASADKAIAKAIkIQUgAkEYaiACQSBqQRhqKQMANwMAIAJBEGogAkEgakEQaikDADcDACACQQhqIAJBIGpBCGopAwA3AwAgAiACKQMgNwMAIAMgACACIAEgBCAFEQoAIAJBwABqJAALkgEBA3xEAAAAAAAA8D8gACAAoiICRAAAAAAAAOA/oiIDoSIERAAAAAAAAPA/IAShIAOhIAIgAiACIAJEkBXLGaAB+j6iRHdRwRZswVa/oKJETFVVVVVVpT+goiACIAKiIgMgA6IgAiACRNQ4iL7p+qi9okTEsbS9nu4hPqCiRK1SnIBPfpK+oKKgoiAAIAGioaCgC8gSAhB/A3wjAEGwBGsiBSQAIAJBfWpBGG0iBkEAIAZBAEobIgdBaGwgAmohCAJAIARBAnRBgCVqKAIAIgkgA0F/aiIKakEASA0AIAkgA2ohCyAHIAprIQJBACEGA0ACQAJAIAJBAE4NAEQAAAAAAAAAACEVDAELIAJBAnRBkCVqKAIAtyEVCyAFQcACaiAGQQN0aiAVOQMAIAJBAWohAiAGQQFqIgYgC0cNAAsLIAhBaGohDEEAIQsgCUEAIAlBAEobIQ0gA0EBSCEOA0ACQAJAIA5FDQBEAAAAAAAAAAAhFQwBCyALIApqIQZBACECRAAAAAAAAAAAIRUDQCAAIAJBA3RqKwMAIAVBwAJqIAYgAmtBA3RqKwMAoiAVoCEVIAJBAWoiAiADRw0ACwsgBSALQQN0aiAVOQMAIAsgDUYhAiALQQFqIQsgAkUNAAtBLyAIayEPQTAgCGshECAIQWdqIREgCSELAkADQCAFIAtBA3RqKwMAIRVBACECIAshBgJAIAtBAUgiCg0AA0AgAkECdCENAkACQCAVRAAAAAAAAHA+oiIWmUQAAAAAAADgQWNFDQAgFqohDgwBC0GAgICAeCEOCyAFQeADaiANaiENAkACQCAOtyIWRAAAAAAAAHDBoiAVoCIVmUQAAAAAAADgQWNFDQAgFaohDgwBC0GAgICAeCEOCyANIA42AgAgBSAGQX9qIgZBA3RqKwMAIBagIRUgAkEBaiICIAtHDQALCyAVIAwQ2wEhFQJAAkAgFSAVRAAAAAAAAMA/ohDFAUQAAAAAAAAgwKKgIhWZRAAAAAAAAOBBY0UNACAVqiESDAELQYCAgIB4IRILIBUgErehIRUCQAJAAkACQAJAIAxBAUgiEw0AIAtBAnQgBUHgA2pqQXxqIgIgAigCACICIAIgEHUiAiAQdGsiBjYCACAGIA91IRQgAiASaiESDAELIAwNASALQQJ0IAVB4ANqakF8aigCAEEXdSEUCyAUQQFIDQIMAQtBAiEUIBVEAAAAAAAA4D9mDQBBACEUDAELQQAhAkEAIQ4CQCAKDQADQCAFQeADaiACQQJ0aiIKKAIAIQZB////ByENAkACQCAODQBBgICACCENIAYNAEEAIQ4MAQsgCiANIAZrNgIAQQEhDgsgAkEBaiICIAtHDQALCwJAIBMNAEH///8DIQICQAJAIBEOAgEAAgtB////ASECCyALQQJ0IAVB4ANqakF8aiIGIAYoAgAgAnE2AgALIBJBAWohEiAUQQJHDQBEAAAAAAAA8D8gFaEhFUECIRQgDkUNACAVRAAAAAAAAPA/IAwQ2wGhIRULAkAgFUQAAAAAAAAAAGINAEEAIQYgCyECAkAgCyAJTA0AA0AgBUHgA2ogAkF/aiICQQJ0aigCACAGciEGIAIgCUoNAAsgBkUNACAMIQgDQCAIQWhqIQggBUHgA2ogC0F/aiILQQJ0aigCAEUNAAwECwALQQEhAgNAIAIiBkEBaiECIAVB4ANqIAkgBmtBAnRqKAIARQ0ACyAGIAtqIQ0DQCAFQcACaiALIANqIgZBA3RqIAtBAWoiCyAHakECdEGQJWooAgC3OQMAQQAhAkQAAAAAAAAAACEVAkAgA0EBSA0AA0AgACACQQN0aisDACAFQcACaiAGIAJrQQN0aisDAKIgFaAhFSACQQFqIgIgA0cNAAsLIAUgC0EDdGogFTkDACALIA1IDQALIA0hCwwBCwsCQAJAIBVBGCAIaxDbASIVRAAAAAAAAHBBZkUNACALQQJ0IQMCQAJAIBVEAAAAAAAAcD6iIhaZRAAAAAAAAOBBY0UNACAWqiECDAELQYCAgIB4IQILIAVB4ANqIANqIQMCQAJAIAK3RAAAAAAAAHDBoiAVoCIVmUQAAAAAAADgQWNFDQAgFaohBgwBC0GAgICAeCEGCyADIAY2AgAgC0EBaiELDAELAkACQCAVmUQAAAAAAADgQWNFDQAgFaohAgwBC0GAgICAeCECCyAMIQgLIAVB4ANqIAtBAnRqIAI2AgALRAAAAAAAAPA/IAgQ2wEhFQJAIAtBf0wNACALIQMDQCAFIAMiAkEDdGogFSAFQeADaiACQQJ0aigCALeiOQMAIAJBf2ohAyAVRAAAAAAAAHA+oiEVIAINAAsgC0F/TA0AIAshAgNAIAsgAiIGayEARAAAAAAAAAAAIRVBACECAkADQCACQQN0QeA6aisDACAFIAIgBmpBA3RqKwMAoiAVoCEVIAIgCU4NASACIABJIQMgAkEBaiECIAMNAAsLIAVBoAFqIABBA3RqIBU5AwAgBkF/aiECIAZBAEoNAAsLAkACQAJAAkACQCAEDgQBAgIABAtEAAAAAAAAAAAhFwJAIAtBAUgNACAFQaABaiALQQN0aisDACEVIAshAgNAIAVBoAFqIAJBA3RqIBUgBUGgAWogAkF/aiIDQQN0aiIGKwMAIhYgFiAVoCIWoaA5AwAgBiAWOQMAIAJBAUshBiAWIRUgAyECIAYNAAsgC0ECSA0AIAVBoAFqIAtBA3RqKwMAIRUgCyECA0AgBUGgAWogAkEDdGogFSAFQaABaiACQX9qIgNBA3RqIgYrAwAiFiAWIBWgIhahoDkDACAGIBY5AwAgAkECSyEGIBYhFSADIQIgBg0AC0QAAAAAAAAAACEXIAtBAUwNAANAIBcgBUGgAWogC0EDdGorAwCgIRcgC0ECSiECIAtBf2ohCyACDQALCyAFKwOgASEVIBQNAiABIBU5AwAgBSsDqAEhFSABIBc5AxAgASAVOQMIDAMLRAAAAAAAAAAAIRUCQCALQQBIDQADQCALIgJBf2ohCyAVIAVBoAFqIAJBA3RqKwMAoCEVIAINAAsLIAEgFZogFSAUGzkDAAwCC0QAAAAAAAAAACEVAkAgC0EASA0AIAshAwNAIAMiAkF/aiEDIBUgBUGgAWogAkEDdGorAwCgIRUgAg0ACwsgASAVmiAVIBQbOQMAIAUrA6ABIBWhIRVBASECAkAgC0EBSA0AA0AgFSAFQaABaiACQQN0aisDAKAhFSACIAtHIQMgAkEBaiECIAMNAAsLIAEgFZogFSAUGzkDCAwBCyABIBWaOQMAIAUrA6gBIRUgASAXmjkDECABIBWaOQMICyAFQbAEaiQAIBJBB3ELhwsDBX8BfgR8IwBBMGsiAiQAAkACQAJAAkAgAL0iB0IgiKciA0H/////B3EiBEH61L2ABEsNACADQf//P3FB+8MkRg0BAkAgBEH8souABEsNAAJAIAdCAFMNACABIABEAABAVPsh+b+gIgBEMWNiGmG00L2gIgg5AwAgASAAIAihRDFjYhphtNC9oDkDCEEBIQMMBQsgASAARAAAQFT7Ifk/oCIARDFjYhphtNA9oCIIOQMAIAEgACAIoUQxY2IaYbTQPaA5AwhBfyEDDAQLAkAgB0IAUw0AIAEgAEQAAEBU+yEJwKAiAEQxY2IaYbTgvaAiCDkDACABIAAgCKFEMWNiGmG04L2gOQMIQQIhAwwECyABIABEAABAVPshCUCgIgBEMWNiGmG04D2gIgg5AwAgASAAIAihRDFjYhphtOA9oDkDCEF+IQMMAwsCQCAEQbuM8YAESw0AAkAgBEG8+9eABEsNACAEQfyyy4AERg0CAkAgB0IAUw0AIAEgAEQAADB/fNkSwKAiAETKlJOnkQ7pvaAiCDkDACABIAAgCKFEypSTp5EO6b2gOQMIQQMhAwwFCyABIABEAAAwf3zZEkCgIgBEypSTp5EO6T2gIgg5AwAgASAAIAihRMqUk6eRDuk9oDkDCEF9IQMMBAsgBEH7w+SABEYNAQJAIAdCAFMNACABIABEAABAVPshGcCgIgBEMWNiGmG08L2gIgg5AwAgASAAIAihRDFjYhphtPC9oDkDCEEEIQMMBAsgASAARAAAQFT7IRlAoCIARDFjYhphtPA9oCIIOQMAIAEgACAIoUQxY2IaYbTwPaA5AwhBfCEDDAMLIARB+sPkiQRLDQELIAAgAESDyMltMF/kP6JEAAAAAAAAOEOgRAAAAAAAADjDoCIIRAAAQFT7Ifm/oqAiCSAIRDFjYhphtNA9oiIKoSILRBgtRFT7Iem/YyEFAkACQCAImUQAAAAAAADgQWNFDQAgCKohAwwBC0GAgICAeCEDCwJAAkAgBUUNACADQX9qIQMgCEQAAAAAAADwv6AiCEQxY2IaYbTQPaIhCiAAIAhEAABAVPsh+b+ioCEJDAELIAtEGC1EVPsh6T9kRQ0AIANBAWohAyAIRAAAAAAAAPA/oCIIRDFjYhphtNA9oiEKIAAgCEQAAEBU+yH5v6KgIQkLIAEgCSAKoSIAOQMAAkAgBEEUdiIFIAC9QjSIp0H/D3FrQRFIDQAgASAJIAhEAABgGmG00D2iIgChIgsgCERzcAMuihmjO6IgCSALoSAAoaEiCqEiADkDAAJAIAUgAL1CNIinQf8PcWtBMk4NACALIQkMAQsgASALIAhEAAAALooZozuiIgChIgkgCETBSSAlmoN7OaIgCyAJoSAAoaEiCqEiADkDAAsgASAJIAChIAqhOQMIDAELAkAgBEGAgMD/B0kNACABIAAgAKEiADkDACABIAA5AwhBACEDDAELIAdC/////////weDQoCAgICAgICwwQCEvyEAQQAhA0EBIQUDQCACQRBqIANBA3RqIQMCQAJAIACZRAAAAAAAAOBBY0UNACAAqiEGDAELQYCAgIB4IQYLIAMgBrciCDkDACAAIAihRAAAAAAAAHBBoiEAQQEhAyAFQQFxIQZBACEFIAYNAAsgAiAAOQMgAkACQCAARAAAAAAAAAAAYQ0AQQIhAwwBC0EBIQUDQCAFIgNBf2ohBSACQRBqIANBA3RqKwMARAAAAAAAAAAAYQ0ACwsgAkEQaiACIARBFHZB6ndqIANBAWpBARC7ASEDIAIrAwAhAAJAIAdCf1UNACABIACaOQMAIAEgAisDCJo5AwhBACADayEDDAELIAEgADkDACABIAIrAwg5AwgLIAJBMGokACADC5oBAQN8IAAgAKIiAyADIAOioiADRHzVz1o62eU9okTrnCuK5uVavqCiIAMgA0R9/rFX4x3HPqJE1WHBGaABKr+gokSm+BARERGBP6CgIQQgAyAAoiEFAkAgAg0AIAUgAyAEokRJVVVVVVXFv6CiIACgDwsgACADIAFEAAAAAAAA4D+iIAQgBaKhoiABoSAFRElVVVVVVcU/oqChC9oBAgJ/AXwjAEEQayIBJAACQAJAIAC9QiCIp0H/////B3EiAkH7w6T/A0sNAEQAAAAAAADwPyEDIAJBnsGa8gNJDQEgAEQAAAAAAAAAABC6ASEDDAELAkAgAkGAgMD/B0kNACAAIAChIQMMAQsCQAJAAkACQCAAIAEQvAFBA3EOAwABAgMLIAErAwAgASsDCBC6ASEDDAMLIAErAwAgASsDCEEBEL0BmiEDDAILIAErAwAgASsDCBC6AZohAwwBCyABKwMAIAErAwhBARC9ASEDCyABQRBqJAAgAwuPBAEDfwJAIAJBgARJDQAgACABIAIQARogAA8LIAAgAmohAwJAAkAgASAAc0EDcQ0AAkACQCAAQQNxDQAgACECDAELAkAgAg0AIAAhAgwBCyAAIQIDQCACIAEtAAA6AAAgAUEBaiEBIAJBAWoiAkEDcUUNASACIANJDQALCwJAIANBfHEiBEHAAEkNACACIARBQGoiBUsNAANAIAIgASgCADYCACACIAEoAgQ2AgQgAiABKAIINgIIIAIgASgCDDYCDCACIAEoAhA2AhAgAiABKAIUNgIUIAIgASgCGDYCGCACIAEoAhw2AhwgAiABKAIgNgIgIAIgASgCJDYCJCACIAEoAig2AiggAiABKAIsNgIsIAIgASgCMDYCMCACIAEoAjQ2AjQgAiABKAI4NgI4IAIgASgCPDYCPCABQcAAaiEBIAJBwABqIgIgBU0NAAsLIAIgBE8NAQNAIAIgASgCADYCACABQQRqIQEgAkEEaiICIARJDQAMAgsACwJAIANBBE8NACAAIQIMAQsCQCADQXxqIgQgAE8NACAAIQIMAQsgACECA0AgAiABLQAAOgAAIAIgAS0AAToAASACIAEtAAI6AAIgAiABLQADOgADIAFBBGohASACQQRqIgIgBE0NAAsLAkAgAiADTw0AA0AgAiABLQAAOgAAIAFBAWohASACQQFqIgIgA0cNAAsLIAALEAAgAZogASAAGxDBASABogsVAQF/IwBBEGsiASAAOQMIIAErAwgLEAAgAEQAAAAAAAAAEBDAAQsQACAARAAAAAAAAABwEMABCwUAIACZCwUAIACcCygBAX8jAEEQayIDJAAgAyACNgIMIAAgASACEPUBIQIgA0EQaiQAIAILBABBAQsCAAtcAQF/IAAgACgCSCIBQX9qIAFyNgJIAkAgACgCACIBQQhxRQ0AIAAgAUEgcjYCAEF/DwsgAEIANwIEIAAgACgCLCIBNgIcIAAgATYCFCAAIAEgACgCMGo2AhBBAAuRAQEDfyMAQRBrIgIkACACIAE6AA8CQAJAIAAoAhAiAw0AQX8hAyAAEMkBDQEgACgCECEDCwJAIAAoAhQiBCADRg0AIAAoAlAgAUH/AXEiA0YNACAAIARBAWo2AhQgBCABOgAADAELQX8hAyAAIAJBD2pBASAAKAIkEQUAQQFHDQAgAi0ADyEDCyACQRBqJAAgAwsJACAAIAEQzAELcgECfwJAAkAgASgCTCICQQBIDQAgAkUNASACQf////97cRDZASgCEEcNAQsCQCAAQf8BcSICIAEoAlBGDQAgASgCFCIDIAEoAhBGDQAgASADQQFqNgIUIAMgADoAACACDwsgASACEMoBDwsgACABEM0BC3UBA38CQCABQcwAaiICEM4BRQ0AIAEQxwEaCwJAAkAgAEH/AXEiAyABKAJQRg0AIAEoAhQiBCABKAIQRg0AIAEgBEEBajYCFCAEIAA6AAAMAQsgASADEMoBIQMLAkAgAhDPAUGAgICABHFFDQAgAhDQAQsgAwsbAQF/IAAgACgCACIBQf////8DIAEbNgIAIAELFAEBfyAAKAIAIQEgAEEANgIAIAELCgAgAEEBENEBGgsEAEEACwwAIAAgAKEiACAAowugCQMGfwN+CXwjAEEQayICJAAgAb0iCEI0iKciA0H/D3EiBEHCd2ohBQJAAkACQCAAvSIJQjSIpyIGQYFwakGCcEkNAEEAIQcgBUH/fksNAQsCQCAIQgGGIgpCf3xC/////////29UDQBEAAAAAAAA8D8hCyAJQoCAgICAgID4P1ENAiAKUA0CAkACQCAJQgGGIglCgICAgICAgHBWDQAgCkKBgICAgICAcFQNAQsgACABoCELDAMLIAlCgICAgICAgPD/AFENAkQAAAAAAAAAACABIAGiIAhCP4inQQFzIAlCgICAgICAgPD/AFRGGyELDAILAkAgCUIBhkJ/fEL/////////b1QNACAAIACiIQsCQCAJQn9VDQAgC5ogCyAIENQBQQFGGyELCyAIQn9VDQIgAkQAAAAAAADwPyALozkDCCACKwMIIQsMAgtBACEHAkAgCUJ/VQ0AAkAgCBDUASIHDQAgABDSASELDAMLIAZB/w9xIQYgCUL///////////8AgyEJIAdBAUZBEnQhBwsCQCAFQf9+Sw0ARAAAAAAAAPA/IQsgCUKAgICAgICA+D9RDQICQCAEQb0HSw0AIAEgAZogCUKAgICAgICA+D9WG0QAAAAAAADwP6AhCwwDCwJAIANBgBBJIAlCgYCAgICAgPg/VEYNAEEAEMMBIQsMAwtBABDCASELDAILIAYNACAARAAAAAAAADBDor1C////////////AINCgICAgICAgOB8fCEJCwJAIAhCgICAQIO/IgwgCSAJQoCAgICw1dqMQHwiCEKAgICAgICAeIN9IglCgICAgAh8QoCAgIBwg78iCyAIQi2Ip0H/AHFBBXQiBUHYzABqKwMAIg2iRAAAAAAAAPC/oCIAIABBACsDoEwiDqIiD6IiECAIQjSHp7ciEUEAKwOQTKIgBUHozABqKwMAoCISIAAgDSAJvyALoaIiE6AiAKAiC6AiDSAQIAsgDaGgIBMgDyAOIACiIg6goiARQQArA5hMoiAFQfDMAGorAwCgIAAgEiALoaCgoKAgACAAIA6iIguiIAsgCyAAQQArA9BMokEAKwPITKCiIABBACsDwEyiQQArA7hMoKCiIABBACsDsEyiQQArA6hMoKCioCIPoCILvUKAgIBAg78iDqIiAL0iCUI0iKdB/w9xIgVBt3hqQT9JDQACQCAFQcgHSw0AIABEAAAAAAAA8D+gIgCaIAAgBxshCwwCCyAFQYkISSEGQQAhBSAGDQACQCAJQn9VDQAgBxDCASELDAILIAcQwwEhCwwBCyABIAyhIA6iIA8gDSALoaAgCyAOoaAgAaKgIABBACsDoDuiQQArA6g7IgGgIgsgAaEiAUEAKwO4O6IgAUEAKwOwO6IgAKCgoCIAIACiIgEgAaIgAEEAKwPYO6JBACsD0DugoiABIABBACsDyDuiQQArA8A7oKIgC70iCadBBHRB8A9xIgZBkDxqKwMAIACgoKAhACAGQZg8aikDACAJIAetfEIthnwhCAJAIAUNACAAIAggCRDVASELDAELIAi/IgEgAKIgAaAhCwsgAkEQaiQAIAsLVQICfwF+QQAhAQJAIABCNIinQf8PcSICQf8HSQ0AQQIhASACQbMISw0AQQAhAUIBQbMIIAJrrYYiA0J/fCAAg0IAUg0AQQJBASADIACDUBshAQsgAQuKAgIBfwR8IwBBEGsiAyQAAkACQCACQoCAgIAIg0IAUg0AIAFCgICAgICAgPhAfL8iBCAAoiAEoEQAAAAAAAAAf6IhAAwBCwJAIAFCgICAgICAgPA/fCIBvyIEIACiIgUgBKAiABDEAUQAAAAAAADwP2NFDQAgA0KAgICAgICACDcDCCADIAMrAwhEAAAAAAAAEACiOQMIIAFCgICAgICAgICAf4O/IABEAAAAAAAA8L9EAAAAAAAA8D8gAEQAAAAAAAAAAGMbIgagIgcgBSAEIAChoCAAIAYgB6GgoKAgBqEiACAARAAAAAAAAAAAYRshAAsgAEQAAAAAAAAQAKIhAAsgA0EQaiQAIAAL8gICA38BfgJAIAJFDQAgACABOgAAIAIgAGoiA0F/aiABOgAAIAJBA0kNACAAIAE6AAIgACABOgABIANBfWogAToAACADQX5qIAE6AAAgAkEHSQ0AIAAgAToAAyADQXxqIAE6AAAgAkEJSQ0AIABBACAAa0EDcSIEaiIDIAFB/wFxQYGChAhsIgE2AgAgAyACIARrQXxxIgRqIgJBfGogATYCACAEQQlJDQAgAyABNgIIIAMgATYCBCACQXhqIAE2AgAgAkF0aiABNgIAIARBGUkNACADIAE2AhggAyABNgIUIAMgATYCECADIAE2AgwgAkFwaiABNgIAIAJBbGogATYCACACQWhqIAE2AgAgAkFkaiABNgIAIAQgA0EEcUEYciIFayICQSBJDQAgAa1CgYCAgBB+IQYgAyAFaiEBA0AgASAGNwMYIAEgBjcDECABIAY3AwggASAGNwMAIAFBIGohASACQWBqIgJBH0sNAAsLIAALBABBKgsFABDXAQsGAEHU8gALFQBBAEG88gA2AqxzQQAQ2AE2AuRyC64BAAJAAkAgAUGACEgNACAARAAAAAAAAOB/oiEAAkAgAUH/D08NACABQYF4aiEBDAILIABEAAAAAAAA4H+iIQAgAUH9FyABQf0XSRtBgnBqIQEMAQsgAUGBeEoNACAARAAAAAAAAGADoiEAAkAgAUG4cE0NACABQckHaiEBDAELIABEAAAAAAAAYAOiIQAgAUHwaCABQfBoSxtBkg9qIQELIAAgAUH/B2qtQjSGv6ILzwEBAn8jAEEQayIBJAACQAJAIAC9QiCIp0H/////B3EiAkH7w6T/A0sNACACQYCAwPIDSQ0BIABEAAAAAAAAAABBABC9ASEADAELAkAgAkGAgMD/B0kNACAAIAChIQAMAQsCQAJAAkACQCAAIAEQvAFBA3EOAwABAgMLIAErAwAgASsDCEEBEL0BIQAMAwsgASsDACABKwMIELoBIQAMAgsgASsDACABKwMIQQEQvQGaIQAMAQsgASsDACABKwMIELoBmiEACyABQRBqJAAgAAsEACAACwwAIAAoAjwQ3QEQAgvYAgEHfyMAQSBrIgMkACADIAAoAhwiBDYCECAAKAIUIQUgAyACNgIcIAMgATYCGCADIAUgBGsiATYCFCABIAJqIQZBAiEHIANBEGohAQJAAkACQAJAIAAoAjwgA0EQakECIANBDGoQAxD2AQ0AA0AgBiADKAIMIgRGDQIgBEF/TA0DIAEgBCABKAIEIghLIgVBA3RqIgkgCSgCACAEIAhBACAFG2siCGo2AgAgAUEMQQQgBRtqIgkgCSgCACAIazYCACAGIARrIQYgACgCPCABQQhqIAEgBRsiASAHIAVrIgcgA0EMahADEPYBRQ0ACwsgBkF/Rw0BCyAAIAAoAiwiATYCHCAAIAE2AhQgACABIAAoAjBqNgIQIAIhBAwBC0EAIQQgAEEANgIcIABCADcDECAAIAAoAgBBIHI2AgAgB0ECRg0AIAIgASgCBGshBAsgA0EgaiQAIAQLOQEBfyMAQRBrIgMkACAAIAEgAkH/AXEgA0EIahCJAhD2ASEAIAMpAwghASADQRBqJABCfyABIAAbCw4AIAAoAjwgASACEOABCwoAIABBUGpBCkkL5QEBAn8gAkEARyEDAkACQAJAIABBA3FFDQAgAkUNACABQf8BcSEEA0AgAC0AACAERg0CIAJBf2oiAkEARyEDIABBAWoiAEEDcUUNASACDQALCyADRQ0BCwJAIAAtAAAgAUH/AXFGDQAgAkEESQ0AIAFB/wFxQYGChAhsIQQDQCAAKAIAIARzIgNBf3MgA0H//ft3anFBgIGChHhxDQEgAEEEaiEAIAJBfGoiAkEDSw0ACwsgAkUNACABQf8BcSEDA0ACQCAALQAAIANHDQAgAA8LIABBAWohACACQX9qIgINAAsLQQALFwEBfyAAQQAgARDjASICIABrIAEgAhsLBgBBzPMAC48BAgF+AX8CQCAAvSICQjSIp0H/D3EiA0H/D0YNAAJAIAMNAAJAAkAgAEQAAAAAAAAAAGINAEEAIQMMAQsgAEQAAAAAAADwQ6IgARDmASEAIAEoAgBBQGohAwsgASADNgIAIAAPCyABIANBgnhqNgIAIAJC/////////4eAf4NCgICAgICAgPA/hL8hAAsgAAvOAQEDfwJAAkAgAigCECIDDQBBACEEIAIQyQENASACKAIQIQMLAkAgAyACKAIUIgVrIAFPDQAgAiAAIAEgAigCJBEFAA8LAkACQCACKAJQQQBODQBBACEDDAELIAEhBANAAkAgBCIDDQBBACEDDAILIAAgA0F/aiIEai0AAEEKRw0ACyACIAAgAyACKAIkEQUAIgQgA0kNASAAIANqIQAgASADayEBIAIoAhQhBQsgBSAAIAEQvwEaIAIgAigCFCABajYCFCADIAFqIQQLIAQL+wIBBH8jAEHQAWsiBSQAIAUgAjYCzAFBACEGIAVBoAFqQQBBKBDWARogBSAFKALMATYCyAECQAJAQQAgASAFQcgBaiAFQdAAaiAFQaABaiADIAQQ6QFBAE4NAEF/IQEMAQsCQCAAKAJMQQBIDQAgABDHASEGCyAAKAIAIQcCQCAAKAJIQQBKDQAgACAHQV9xNgIACwJAAkACQAJAIAAoAjANACAAQdAANgIwIABBADYCHCAAQgA3AxAgACgCLCEIIAAgBTYCLAwBC0EAIQggACgCEA0BC0F/IQIgABDJAQ0BCyAAIAEgBUHIAWogBUHQAGogBUGgAWogAyAEEOkBIQILIAdBIHEhAQJAIAhFDQAgAEEAQQAgACgCJBEFABogAEEANgIwIAAgCDYCLCAAQQA2AhwgACgCFCEDIABCADcDECACQX8gAxshAgsgACAAKAIAIgMgAXI2AgBBfyACIANBIHEbIQEgBkUNACAAEMgBCyAFQdABaiQAIAELnRMCEX8BfiMAQdAAayIHJAAgByABNgJMIAdBN2ohCCAHQThqIQlBACEKQQAhC0EAIQECQAJAAkACQANAIAFB/////wcgC2tKDQEgASALaiELIAcoAkwiDCEBAkACQAJAAkACQCAMLQAAIg1FDQADQAJAAkACQCANQf8BcSINDQAgASENDAELIA1BJUcNASABIQ0DQCABLQABQSVHDQEgByABQQJqIg42AkwgDUEBaiENIAEtAAIhDyAOIQEgD0ElRg0ACwsgDSAMayIBQf////8HIAtrIg1KDQgCQCAARQ0AIAAgDCABEOoBCyABDQdBfyEQQQEhDiAHKAJMLAABEOIBIQ8gBygCTCEBAkAgD0UNACABLQACQSRHDQAgASwAAUFQaiEQQQEhCkEDIQ4LIAcgASAOaiIBNgJMQQAhEQJAAkAgASwAACISQWBqIg9BH00NACABIQ4MAQtBACERIAEhDkEBIA90Ig9BidEEcUUNAANAIAcgAUEBaiIONgJMIA8gEXIhESABLAABIhJBYGoiD0EgTw0BIA4hAUEBIA90Ig9BidEEcQ0ACwsCQAJAIBJBKkcNAAJAAkAgDiwAARDiAUUNACAHKAJMIg4tAAJBJEcNACAOLAABQQJ0IARqQcB+akEKNgIAIA5BA2ohASAOLAABQQN0IANqQYB9aigCACETQQEhCgwBCyAKDQZBACEKQQAhEwJAIABFDQAgAiACKAIAIgFBBGo2AgAgASgCACETCyAHKAJMQQFqIQELIAcgATYCTCATQX9KDQFBACATayETIBFBgMAAciERDAELIAdBzABqEOsBIhNBAEgNCSAHKAJMIQELQQAhDkF/IRQCQAJAIAEtAABBLkYNAEEAIRUMAQsCQCABLQABQSpHDQACQAJAIAEsAAIQ4gFFDQAgBygCTCIPLQADQSRHDQAgDywAAkECdCAEakHAfmpBCjYCACAPQQRqIQEgDywAAkEDdCADakGAfWooAgAhFAwBCyAKDQYCQAJAIAANAEEAIRQMAQsgAiACKAIAIgFBBGo2AgAgASgCACEUCyAHKAJMQQJqIQELIAcgATYCTCAUQX9zQR92IRUMAQsgByABQQFqNgJMQQEhFSAHQcwAahDrASEUIAcoAkwhAQsDQCAOIQ9BHCEWIAEsAABBhX9qQUZJDQogByABQQFqIhI2AkwgASwAACEOIBIhASAOIA9BOmxqQZ/sAGotAAAiDkF/akEISQ0ACwJAAkACQCAOQRtGDQAgDkUNDAJAIBBBAEgNACAEIBBBAnRqIA42AgAgByADIBBBA3RqKQMANwNADAILIABFDQkgB0HAAGogDiACIAYQ7AEgBygCTCESDAILIBBBf0oNCwtBACEBIABFDQgLIBFB//97cSIXIBEgEUGAwABxGyEOQQAhEUGnCCEQIAkhFgJAAkACQAJAAkACQAJAAkACQAJAAkACQAJAAkACQAJAIBJBf2osAAAiAUFfcSABIAFBD3FBA0YbIAEgDxsiAUGof2oOIQQVFRUVFRUVFQ4VDwYODg4VBhUVFRUCBQMVFQkVARUVBAALIAkhFgJAIAFBv39qDgcOFQsVDg4OAAsgAUHTAEYNCQwTC0EAIRFBpwghECAHKQNAIRgMBQtBACEBAkACQAJAAkACQAJAAkAgD0H/AXEOCAABAgMEGwUGGwsgBygCQCALNgIADBoLIAcoAkAgCzYCAAwZCyAHKAJAIAusNwMADBgLIAcoAkAgCzsBAAwXCyAHKAJAIAs6AAAMFgsgBygCQCALNgIADBULIAcoAkAgC6w3AwAMFAsgFEEIIBRBCEsbIRQgDkEIciEOQfgAIQELIAcpA0AgCSABQSBxEO0BIQxBACERQacIIRAgBykDQFANAyAOQQhxRQ0DIAFBBHZBpwhqIRBBAiERDAMLQQAhEUGnCCEQIAcpA0AgCRDuASEMIA5BCHFFDQIgFCAJIAxrIgFBAWogFCABShshFAwCCwJAIAcpA0AiGEJ/VQ0AIAdCACAYfSIYNwNAQQEhEUGnCCEQDAELAkAgDkGAEHFFDQBBASERQagIIRAMAQtBqQhBpwggDkEBcSIRGyEQCyAYIAkQ7wEhDAsCQCAVRQ0AIBRBAEgNEAsgDkH//3txIA4gFRshDgJAIAcpA0AiGEIAUg0AIBQNACAJIQwgCSEWQQAhFAwNCyAUIAkgDGsgGFBqIgEgFCABShshFAwLC0EAIREgBygCQCIBQagfIAEbIQwgDCAMQf////8HIBQgFEEASBsQ5AEiAWohFgJAIBRBf0wNACAXIQ4gASEUDAwLIBchDiABIRQgFi0AAA0ODAsLAkAgFEUNACAHKAJAIQ0MAgtBACEBIABBICATQQAgDhDwAQwCCyAHQQA2AgwgByAHKQNAPgIIIAcgB0EIajYCQEF/IRQgB0EIaiENC0EAIQECQANAIA0oAgAiD0UNAQJAIAdBBGogDxD4ASIPQQBIIgwNACAPIBQgAWtLDQAgDUEEaiENIBQgDyABaiIBSw0BDAILCyAMDQ4LQT0hFiABQQBIDQwgAEEgIBMgASAOEPABAkAgAQ0AQQAhAQwBC0EAIQ8gBygCQCENA0AgDSgCACIMRQ0BIAdBBGogDBD4ASIMIA9qIg8gAUsNASAAIAdBBGogDBDqASANQQRqIQ0gDyABSQ0ACwsgAEEgIBMgASAOQYDAAHMQ8AEgEyABIBMgAUobIQEMCQsCQCAVRQ0AIBRBAEgNCgtBPSEWIAAgBysDQCATIBQgDiABIAURFgAiAUEATg0IDAoLIAcgBykDQDwAN0EBIRQgCCEMIAkhFiAXIQ4MBQsgByABQQFqIg42AkwgAS0AASENIA4hAQwACwALIAANCCAKRQ0DQQEhAQJAA0AgBCABQQJ0aigCACINRQ0BIAMgAUEDdGogDSACIAYQ7AFBASELIAFBAWoiAUEKRw0ADAoLAAtBASELIAFBCk8NCANAIAQgAUECdGooAgANAUEBIQsgAUEBaiIBQQpGDQkMAAsAC0EcIRYMBQsgCSEWCyAWIAxrIhIgFCAUIBJIGyIUQf////8HIBFrSg0CQT0hFiARIBRqIg8gEyATIA9IGyIBIA1KDQMgAEEgIAEgDyAOEPABIAAgECAREOoBIABBMCABIA8gDkGAgARzEPABIABBMCAUIBJBABDwASAAIAwgEhDqASAAQSAgASAPIA5BgMAAcxDwAQwBCwtBACELDAMLQT0hFgsQ5QEgFjYCAAtBfyELCyAHQdAAaiQAIAsLGQACQCAALQAAQSBxDQAgASACIAAQ5wEaCwt0AQN/QQAhAQJAIAAoAgAsAAAQ4gENAEEADwsDQCAAKAIAIQJBfyEDAkAgAUHMmbPmAEsNAEF/IAIsAABBUGoiAyABQQpsIgFqIANB/////wcgAWtKGyEDCyAAIAJBAWo2AgAgAyEBIAIsAAEQ4gENAAsgAwu2BAACQAJAAkACQAJAAkACQAJAAkACQAJAAkACQAJAAkACQAJAAkACQCABQXdqDhIAAQIFAwQGBwgJCgsMDQ4PEBESCyACIAIoAgAiAUEEajYCACAAIAEoAgA2AgAPCyACIAIoAgAiAUEEajYCACAAIAE0AgA3AwAPCyACIAIoAgAiAUEEajYCACAAIAE1AgA3AwAPCyACIAIoAgAiAUEEajYCACAAIAE0AgA3AwAPCyACIAIoAgAiAUEEajYCACAAIAE1AgA3AwAPCyACIAIoAgBBB2pBeHEiAUEIajYCACAAIAEpAwA3AwAPCyACIAIoAgAiAUEEajYCACAAIAEyAQA3AwAPCyACIAIoAgAiAUEEajYCACAAIAEzAQA3AwAPCyACIAIoAgAiAUEEajYCACAAIAEwAAA3AwAPCyACIAIoAgAiAUEEajYCACAAIAExAAA3AwAPCyACIAIoAgBBB2pBeHEiAUEIajYCACAAIAEpAwA3AwAPCyACIAIoAgAiAUEEajYCACAAIAE1AgA3AwAPCyACIAIoAgBBB2pBeHEiAUEIajYCACAAIAEpAwA3AwAPCyACIAIoAgBBB2pBeHEiAUEIajYCACAAIAEpAwA3AwAPCyACIAIoAgAiAUEEajYCACAAIAE0AgA3AwAPCyACIAIoAgAiAUEEajYCACAAIAE1AgA3AwAPCyACIAIoAgBBB2pBeHEiAUEIajYCACAAIAErAwA5AwAPCyAAIAIgAxEBAAsLPgEBfwJAIABQDQADQCABQX9qIgEgAKdBD3FBsPAAai0AACACcjoAACAAQg9WIQMgAEIEiCEAIAMNAAsLIAELNgEBfwJAIABQDQADQCABQX9qIgEgAKdBB3FBMHI6AAAgAEIHViECIABCA4ghACACDQALCyABC4gBAgF+A38CQAJAIABCgICAgBBaDQAgACECDAELA0AgAUF/aiIBIAAgAEIKgCICQgp+fadBMHI6AAAgAEL/////nwFWIQMgAiEAIAMNAAsLAkAgAqciA0UNAANAIAFBf2oiASADIANBCm4iBEEKbGtBMHI6AAAgA0EJSyEFIAQhAyAFDQALCyABC3MBAX8jAEGAAmsiBSQAAkAgAiADTA0AIARBgMAEcQ0AIAUgAUH/AXEgAiADayICQYACIAJBgAJJIgMbENYBGgJAIAMNAANAIAAgBUGAAhDqASACQYB+aiICQf8BSw0ACwsgACAFIAIQ6gELIAVBgAJqJAALEAAgACABIAJBP0HAABDoAQuuGQMSfwJ+AXwjAEGwBGsiBiQAQQAhByAGQQA2AiwCQAJAIAEQ9AEiGEJ/VQ0AQQEhCEGxCCEJIAGaIgEQ9AEhGAwBCwJAIARBgBBxRQ0AQQEhCEG0CCEJDAELQbcIQbIIIARBAXEiCBshCSAIRSEHCwJAAkAgGEKAgICAgICA+P8Ag0KAgICAgICA+P8AUg0AIABBICACIAhBA2oiCiAEQf//e3EQ8AEgACAJIAgQ6gEgAEGHCUGdESAFQSBxIgsbQdAJQd0RIAsbIAEgAWIbQQMQ6gEgAEEgIAIgCiAEQYDAAHMQ8AEgAiAKIAogAkgbIQwMAQsgBkEQaiENAkACQAJAAkAgASAGQSxqEOYBIgEgAaAiAUQAAAAAAAAAAGENACAGIAYoAiwiCkF/ajYCLCAFQSByIg5B4QBHDQEMAwsgBUEgciIOQeEARg0CQQYgAyADQQBIGyEPIAYoAiwhEAwBCyAGIApBY2oiEDYCLEEGIAMgA0EASBshDyABRAAAAAAAALBBoiEBCyAGQTBqIAZB0AJqIBBBAEgbIhEhCwNAAkACQCABRAAAAAAAAPBBYyABRAAAAAAAAAAAZnFFDQAgAashCgwBC0EAIQoLIAsgCjYCACALQQRqIQsgASAKuKFEAAAAAGXNzUGiIgFEAAAAAAAAAABiDQALAkACQCAQQQFODQAgECEDIAshCiARIRIMAQsgESESIBAhAwNAIANBHSADQR1JGyEDAkAgC0F8aiIKIBJJDQAgA60hGUIAIRgDQCAKIAo1AgAgGYYgGEL/////D4N8IhggGEKAlOvcA4AiGEKAlOvcA359PgIAIApBfGoiCiASTw0ACyAYpyIKRQ0AIBJBfGoiEiAKNgIACwJAA0AgCyIKIBJNDQEgCkF8aiILKAIARQ0ACwsgBiAGKAIsIANrIgM2AiwgCiELIANBAEoNAAsLAkAgA0F/Sg0AIA9BGWpBCW5BAWohEyAOQeYARiEUA0BBACADayILQQkgC0EJSRshFQJAAkAgEiAKSQ0AIBIoAgAhCwwBC0GAlOvcAyAVdiEWQX8gFXRBf3MhF0EAIQMgEiELA0AgCyALKAIAIgwgFXYgA2o2AgAgDCAXcSAWbCEDIAtBBGoiCyAKSQ0ACyASKAIAIQsgA0UNACAKIAM2AgAgCkEEaiEKCyAGIAYoAiwgFWoiAzYCLCARIBIgC0VBAnRqIhIgFBsiCyATQQJ0aiAKIAogC2tBAnUgE0obIQogA0EASA0ACwtBACEDAkAgEiAKTw0AIBEgEmtBAnVBCWwhA0EKIQsgEigCACIMQQpJDQADQCADQQFqIQMgDCALQQpsIgtPDQALCwJAIA9BACADIA5B5gBGG2sgD0EARyAOQecARnFrIgsgCiARa0ECdUEJbEF3ak4NACALQYDIAGoiDEEJbSIWQQJ0IAZBMGpBBEGkAiAQQQBIG2pqQYBgaiEVQQohCwJAIAwgFkEJbGsiDEEHSg0AA0AgC0EKbCELIAxBAWoiDEEIRw0ACwsgFUEEaiEXAkACQCAVKAIAIgwgDCALbiITIAtsayIWDQAgFyAKRg0BCwJAAkAgE0EBcQ0ARAAAAAAAAEBDIQEgC0GAlOvcA0cNASAVIBJNDQEgFUF8ai0AAEEBcUUNAQtEAQAAAAAAQEMhAQtEAAAAAAAA4D9EAAAAAAAA8D9EAAAAAAAA+D8gFyAKRhtEAAAAAAAA+D8gFiALQQF2IhdGGyAWIBdJGyEaAkAgBw0AIAktAABBLUcNACAamiEaIAGaIQELIBUgDCAWayIMNgIAIAEgGqAgAWENACAVIAwgC2oiCzYCAAJAIAtBgJTr3ANJDQADQCAVQQA2AgACQCAVQXxqIhUgEk8NACASQXxqIhJBADYCAAsgFSAVKAIAQQFqIgs2AgAgC0H/k+vcA0sNAAsLIBEgEmtBAnVBCWwhA0EKIQsgEigCACIMQQpJDQADQCADQQFqIQMgDCALQQpsIgtPDQALCyAVQQRqIgsgCiAKIAtLGyEKCwJAA0AgCiILIBJNIgwNASALQXxqIgooAgBFDQALCwJAAkAgDkHnAEYNACAEQQhxIRUMAQsgA0F/c0F/IA9BASAPGyIKIANKIANBe0pxIhUbIApqIQ9Bf0F+IBUbIAVqIQUgBEEIcSIVDQBBdyEKAkAgDA0AIAtBfGooAgAiFUUNAEEKIQxBACEKIBVBCnANAANAIAoiFkEBaiEKIBUgDEEKbCIMcEUNAAsgFkF/cyEKCyALIBFrQQJ1QQlsIQwCQCAFQV9xQcYARw0AQQAhFSAPIAwgCmpBd2oiCkEAIApBAEobIgogDyAKSBshDwwBC0EAIRUgDyADIAxqIApqQXdqIgpBACAKQQBKGyIKIA8gCkgbIQ8LQX8hDCAPQf3///8HQf7///8HIA8gFXIiFhtKDQEgDyAWQQBHakEBaiEXAkACQCAFQV9xIhRBxgBHDQAgA0H/////ByAXa0oNAyADQQAgA0EAShshCgwBCwJAIA0gAyADQR91IgpqIApzrSANEO8BIgprQQFKDQADQCAKQX9qIgpBMDoAACANIAprQQJIDQALCyAKQX5qIhMgBToAAEF/IQwgCkF/akEtQSsgA0EASBs6AAAgDSATayIKQf////8HIBdrSg0CC0F/IQwgCiAXaiIKIAhB/////wdzSg0BIABBICACIAogCGoiFyAEEPABIAAgCSAIEOoBIABBMCACIBcgBEGAgARzEPABAkACQAJAAkAgFEHGAEcNACAGQRBqQQhyIRUgBkEQakEJciEDIBEgEiASIBFLGyIMIRIDQCASNQIAIAMQ7wEhCgJAAkAgEiAMRg0AIAogBkEQak0NAQNAIApBf2oiCkEwOgAAIAogBkEQaksNAAwCCwALIAogA0cNACAGQTA6ABggFSEKCyAAIAogAyAKaxDqASASQQRqIhIgEU0NAAsCQCAWRQ0AIABBsh5BARDqAQsgEiALTw0BIA9BAUgNAQNAAkAgEjUCACADEO8BIgogBkEQak0NAANAIApBf2oiCkEwOgAAIAogBkEQaksNAAsLIAAgCiAPQQkgD0EJSBsQ6gEgD0F3aiEKIBJBBGoiEiALTw0DIA9BCUohDCAKIQ8gDA0ADAMLAAsCQCAPQQBIDQAgCyASQQRqIAsgEksbIRYgBkEQakEIciERIAZBEGpBCXIhAyASIQsDQAJAIAs1AgAgAxDvASIKIANHDQAgBkEwOgAYIBEhCgsCQAJAIAsgEkYNACAKIAZBEGpNDQEDQCAKQX9qIgpBMDoAACAKIAZBEGpLDQAMAgsACyAAIApBARDqASAKQQFqIQogDyAVckUNACAAQbIeQQEQ6gELIAAgCiADIAprIgwgDyAPIAxKGxDqASAPIAxrIQ8gC0EEaiILIBZPDQEgD0F/Sg0ACwsgAEEwIA9BEmpBEkEAEPABIAAgEyANIBNrEOoBDAILIA8hCgsgAEEwIApBCWpBCUEAEPABCyAAQSAgAiAXIARBgMAAcxDwASACIBcgFyACSBshDAwBCyAJIAVBGnRBH3VBCXFqIRcCQCADQQtLDQBBDCADayEKRAAAAAAAADBAIRoDQCAaRAAAAAAAADBAoiEaIApBf2oiCg0ACwJAIBctAABBLUcNACAaIAGaIBqhoJohAQwBCyABIBqgIBqhIQELAkAgBigCLCIKIApBH3UiCmogCnOtIA0Q7wEiCiANRw0AIAZBMDoADyAGQQ9qIQoLIAhBAnIhFSAFQSBxIRIgBigCLCELIApBfmoiFiAFQQ9qOgAAIApBf2pBLUErIAtBAEgbOgAAIARBCHEhDCAGQRBqIQsDQCALIQoCQAJAIAGZRAAAAAAAAOBBY0UNACABqiELDAELQYCAgIB4IQsLIAogC0Gw8ABqLQAAIBJyOgAAIAEgC7ehRAAAAAAAADBAoiEBAkAgCkEBaiILIAZBEGprQQFHDQACQCAMDQAgA0EASg0AIAFEAAAAAAAAAABhDQELIApBLjoAASAKQQJqIQsLIAFEAAAAAAAAAABiDQALQX8hDEH9////ByAVIA0gFmsiE2oiCmsgA0gNAAJAAkAgA0UNACALIAZBEGprIhJBfmogA04NACADQQJqIQsMAQsgCyAGQRBqayISIQsLIABBICACIAogC2oiCiAEEPABIAAgFyAVEOoBIABBMCACIAogBEGAgARzEPABIAAgBkEQaiASEOoBIABBMCALIBJrQQBBABDwASAAIBYgExDqASAAQSAgAiAKIARBgMAAcxDwASACIAogCiACSBshDAsgBkGwBGokACAMCy4BAX8gASABKAIAQQdqQXhxIgJBEGo2AgAgACACKQMAIAJBCGopAwAQgwI5AwALBQAgAL0LDwAgACABIAJBAEEAEOgBCxYAAkAgAA0AQQAPCxDlASAANgIAQX8LowIBAX9BASEDAkACQCAARQ0AIAFB/wBNDQECQAJAENkBKAJYKAIADQAgAUGAf3FBgL8DRg0DEOUBQRk2AgAMAQsCQCABQf8PSw0AIAAgAUE/cUGAAXI6AAEgACABQQZ2QcABcjoAAEECDwsCQAJAIAFBgLADSQ0AIAFBgEBxQYDAA0cNAQsgACABQT9xQYABcjoAAiAAIAFBDHZB4AFyOgAAIAAgAUEGdkE/cUGAAXI6AAFBAw8LAkAgAUGAgHxqQf//P0sNACAAIAFBP3FBgAFyOgADIAAgAUESdkHwAXI6AAAgACABQQZ2QT9xQYABcjoAAiAAIAFBDHZBP3FBgAFyOgABQQQPCxDlAUEZNgIAC0F/IQMLIAMPCyAAIAE6AABBAQsVAAJAIAANAEEADwsgACABQQAQ9wELnS8BC38jAEEQayIBJAACQAJAAkACQAJAAkACQAJAAkACQAJAAkAgAEH0AUsNAAJAQQAoAtBzIgJBECAAQQtqQXhxIABBC0kbIgNBA3YiBHYiAEEDcUUNACAAQX9zQQFxIARqIgVBA3QiBkGA9ABqKAIAIgRBCGohAAJAAkAgBCgCCCIDIAZB+PMAaiIGRw0AQQAgAkF+IAV3cTYC0HMMAQsgAyAGNgIMIAYgAzYCCAsgBCAFQQN0IgVBA3I2AgQgBCAFaiIEIAQoAgRBAXI2AgQMDAsgA0EAKALYcyIHTQ0BAkAgAEUNAAJAAkAgACAEdEECIAR0IgBBACAAa3JxIgBBACAAa3FBf2oiACAAQQx2QRBxIgB2IgRBBXZBCHEiBSAAciAEIAV2IgBBAnZBBHEiBHIgACAEdiIAQQF2QQJxIgRyIAAgBHYiAEEBdkEBcSIEciAAIAR2aiIFQQN0IgZBgPQAaigCACIEKAIIIgAgBkH48wBqIgZHDQBBACACQX4gBXdxIgI2AtBzDAELIAAgBjYCDCAGIAA2AggLIARBCGohACAEIANBA3I2AgQgBCADaiIGIAVBA3QiCCADayIFQQFyNgIEIAQgCGogBTYCAAJAIAdFDQAgB0EDdiIIQQN0QfjzAGohA0EAKALkcyEEAkACQCACQQEgCHQiCHENAEEAIAIgCHI2AtBzIAMhCAwBCyADKAIIIQgLIAMgBDYCCCAIIAQ2AgwgBCADNgIMIAQgCDYCCAtBACAGNgLkc0EAIAU2AthzDAwLQQAoAtRzIglFDQEgCUEAIAlrcUF/aiIAIABBDHZBEHEiAHYiBEEFdkEIcSIFIAByIAQgBXYiAEECdkEEcSIEciAAIAR2IgBBAXZBAnEiBHIgACAEdiIAQQF2QQFxIgRyIAAgBHZqQQJ0QYD2AGooAgAiBigCBEF4cSADayEEIAYhBQJAA0ACQCAFKAIQIgANACAFQRRqKAIAIgBFDQILIAAoAgRBeHEgA2siBSAEIAUgBEkiBRshBCAAIAYgBRshBiAAIQUMAAsACyAGKAIYIQoCQCAGKAIMIgggBkYNAEEAKALgcyAGKAIIIgBLGiAAIAg2AgwgCCAANgIIDAsLAkAgBkEUaiIFKAIAIgANACAGKAIQIgBFDQMgBkEQaiEFCwNAIAUhCyAAIghBFGoiBSgCACIADQAgCEEQaiEFIAgoAhAiAA0ACyALQQA2AgAMCgtBfyEDIABBv39LDQAgAEELaiIAQXhxIQNBACgC1HMiB0UNAEEAIQsCQCADQYACSQ0AQR8hCyADQf///wdLDQAgAEEIdiIAIABBgP4/akEQdkEIcSIAdCIEIARBgOAfakEQdkEEcSIEdCIFIAVBgIAPakEQdkECcSIFdEEPdiAAIARyIAVyayIAQQF0IAMgAEEVanZBAXFyQRxqIQsLQQAgA2shBAJAAkACQAJAIAtBAnRBgPYAaigCACIFDQBBACEAQQAhCAwBC0EAIQAgA0EAQRkgC0EBdmsgC0EfRht0IQZBACEIA0ACQCAFKAIEQXhxIANrIgIgBE8NACACIQQgBSEIIAINAEEAIQQgBSEIIAUhAAwDCyAAIAVBFGooAgAiAiACIAUgBkEddkEEcWpBEGooAgAiBUYbIAAgAhshACAGQQF0IQYgBQ0ACwsCQCAAIAhyDQBBACEIQQIgC3QiAEEAIABrciAHcSIARQ0DIABBACAAa3FBf2oiACAAQQx2QRBxIgB2IgVBBXZBCHEiBiAAciAFIAZ2IgBBAnZBBHEiBXIgACAFdiIAQQF2QQJxIgVyIAAgBXYiAEEBdkEBcSIFciAAIAV2akECdEGA9gBqKAIAIQALIABFDQELA0AgACgCBEF4cSADayICIARJIQYCQCAAKAIQIgUNACAAQRRqKAIAIQULIAIgBCAGGyEEIAAgCCAGGyEIIAUhACAFDQALCyAIRQ0AIARBACgC2HMgA2tPDQAgCCgCGCELAkAgCCgCDCIGIAhGDQBBACgC4HMgCCgCCCIASxogACAGNgIMIAYgADYCCAwJCwJAIAhBFGoiBSgCACIADQAgCCgCECIARQ0DIAhBEGohBQsDQCAFIQIgACIGQRRqIgUoAgAiAA0AIAZBEGohBSAGKAIQIgANAAsgAkEANgIADAgLAkBBACgC2HMiACADSQ0AQQAoAuRzIQQCQAJAIAAgA2siBUEQSQ0AQQAgBTYC2HNBACAEIANqIgY2AuRzIAYgBUEBcjYCBCAEIABqIAU2AgAgBCADQQNyNgIEDAELQQBBADYC5HNBAEEANgLYcyAEIABBA3I2AgQgBCAAaiIAIAAoAgRBAXI2AgQLIARBCGohAAwKCwJAQQAoAtxzIgYgA00NAEEAIAYgA2siBDYC3HNBAEEAKALocyIAIANqIgU2AuhzIAUgBEEBcjYCBCAAIANBA3I2AgQgAEEIaiEADAoLAkACQEEAKAKod0UNAEEAKAKwdyEEDAELQQBCfzcCtHdBAEKAoICAgIAENwKsd0EAIAFBDGpBcHFB2KrVqgVzNgKod0EAQQA2Arx3QQBBADYCjHdBgCAhBAtBACEAIAQgA0EvaiIHaiICQQAgBGsiC3EiCCADTQ0JQQAhAAJAQQAoAoh3IgRFDQBBACgCgHciBSAIaiIJIAVNDQogCSAESw0KC0EALQCMd0EEcQ0EAkACQAJAQQAoAuhzIgRFDQBBkPcAIQADQAJAIAAoAgAiBSAESw0AIAUgACgCBGogBEsNAwsgACgCCCIADQALC0EAEIACIgZBf0YNBSAIIQICQEEAKAKsdyIAQX9qIgQgBnFFDQAgCCAGayAEIAZqQQAgAGtxaiECCyACIANNDQUgAkH+////B0sNBQJAQQAoAoh3IgBFDQBBACgCgHciBCACaiIFIARNDQYgBSAASw0GCyACEIACIgAgBkcNAQwHCyACIAZrIAtxIgJB/v///wdLDQQgAhCAAiIGIAAoAgAgACgCBGpGDQMgBiEACwJAIABBf0YNACADQTBqIAJNDQACQCAHIAJrQQAoArB3IgRqQQAgBGtxIgRB/v///wdNDQAgACEGDAcLAkAgBBCAAkF/Rg0AIAQgAmohAiAAIQYMBwtBACACaxCAAhoMBAsgACEGIABBf0cNBQwDC0EAIQgMBwtBACEGDAULIAZBf0cNAgtBAEEAKAKMd0EEcjYCjHcLIAhB/v///wdLDQEgCBCAAiEGQQAQgAIhACAGQX9GDQEgAEF/Rg0BIAYgAE8NASAAIAZrIgIgA0Eoak0NAQtBAEEAKAKAdyACaiIANgKAdwJAIABBACgChHdNDQBBACAANgKEdwsCQAJAAkACQEEAKALocyIERQ0AQZD3ACEAA0AgBiAAKAIAIgUgACgCBCIIakYNAiAAKAIIIgANAAwDCwALAkACQEEAKALgcyIARQ0AIAYgAE8NAQtBACAGNgLgcwtBACEAQQAgAjYClHdBACAGNgKQd0EAQX82AvBzQQBBACgCqHc2AvRzQQBBADYCnHcDQCAAQQN0IgRBgPQAaiAEQfjzAGoiBTYCACAEQYT0AGogBTYCACAAQQFqIgBBIEcNAAtBACACQVhqIgBBeCAGa0EHcUEAIAZBCGpBB3EbIgRrIgU2AtxzQQAgBiAEaiIENgLocyAEIAVBAXI2AgQgBiAAakEoNgIEQQBBACgCuHc2AuxzDAILIAAtAAxBCHENACAFIARLDQAgBiAETQ0AIAAgCCACajYCBEEAIARBeCAEa0EHcUEAIARBCGpBB3EbIgBqIgU2AuhzQQBBACgC3HMgAmoiBiAAayIANgLccyAFIABBAXI2AgQgBCAGakEoNgIEQQBBACgCuHc2AuxzDAELAkAgBkEAKALgcyIITw0AQQAgBjYC4HMgBiEICyAGIAJqIQVBkPcAIQACQAJAAkACQAJAAkACQANAIAAoAgAgBUYNASAAKAIIIgANAAwCCwALIAAtAAxBCHFFDQELQZD3ACEAA0ACQCAAKAIAIgUgBEsNACAFIAAoAgRqIgUgBEsNAwsgACgCCCEADAALAAsgACAGNgIAIAAgACgCBCACajYCBCAGQXggBmtBB3FBACAGQQhqQQdxG2oiCyADQQNyNgIEIAVBeCAFa0EHcUEAIAVBCGpBB3EbaiICIAsgA2oiA2shBQJAIAQgAkcNAEEAIAM2AuhzQQBBACgC3HMgBWoiADYC3HMgAyAAQQFyNgIEDAMLAkBBACgC5HMgAkcNAEEAIAM2AuRzQQBBACgC2HMgBWoiADYC2HMgAyAAQQFyNgIEIAMgAGogADYCAAwDCwJAIAIoAgQiAEEDcUEBRw0AIABBeHEhBwJAAkAgAEH/AUsNACACKAIIIgQgAEEDdiIIQQN0QfjzAGoiBkYaAkAgAigCDCIAIARHDQBBAEEAKALQc0F+IAh3cTYC0HMMAgsgACAGRhogBCAANgIMIAAgBDYCCAwBCyACKAIYIQkCQAJAIAIoAgwiBiACRg0AIAggAigCCCIASxogACAGNgIMIAYgADYCCAwBCwJAIAJBFGoiACgCACIEDQAgAkEQaiIAKAIAIgQNAEEAIQYMAQsDQCAAIQggBCIGQRRqIgAoAgAiBA0AIAZBEGohACAGKAIQIgQNAAsgCEEANgIACyAJRQ0AAkACQCACKAIcIgRBAnRBgPYAaiIAKAIAIAJHDQAgACAGNgIAIAYNAUEAQQAoAtRzQX4gBHdxNgLUcwwCCyAJQRBBFCAJKAIQIAJGG2ogBjYCACAGRQ0BCyAGIAk2AhgCQCACKAIQIgBFDQAgBiAANgIQIAAgBjYCGAsgAigCFCIARQ0AIAZBFGogADYCACAAIAY2AhgLIAcgBWohBSACIAdqIQILIAIgAigCBEF+cTYCBCADIAVBAXI2AgQgAyAFaiAFNgIAAkAgBUH/AUsNACAFQQN2IgRBA3RB+PMAaiEAAkACQEEAKALQcyIFQQEgBHQiBHENAEEAIAUgBHI2AtBzIAAhBAwBCyAAKAIIIQQLIAAgAzYCCCAEIAM2AgwgAyAANgIMIAMgBDYCCAwDC0EfIQACQCAFQf///wdLDQAgBUEIdiIAIABBgP4/akEQdkEIcSIAdCIEIARBgOAfakEQdkEEcSIEdCIGIAZBgIAPakEQdkECcSIGdEEPdiAAIARyIAZyayIAQQF0IAUgAEEVanZBAXFyQRxqIQALIAMgADYCHCADQgA3AhAgAEECdEGA9gBqIQQCQAJAQQAoAtRzIgZBASAAdCIIcQ0AQQAgBiAIcjYC1HMgBCADNgIAIAMgBDYCGAwBCyAFQQBBGSAAQQF2ayAAQR9GG3QhACAEKAIAIQYDQCAGIgQoAgRBeHEgBUYNAyAAQR12IQYgAEEBdCEAIAQgBkEEcWpBEGoiCCgCACIGDQALIAggAzYCACADIAQ2AhgLIAMgAzYCDCADIAM2AggMAgtBACACQVhqIgBBeCAGa0EHcUEAIAZBCGpBB3EbIghrIgs2AtxzQQAgBiAIaiIINgLocyAIIAtBAXI2AgQgBiAAakEoNgIEQQBBACgCuHc2AuxzIAQgBUEnIAVrQQdxQQAgBUFZakEHcRtqQVFqIgAgACAEQRBqSRsiCEEbNgIEIAhBEGpBACkCmHc3AgAgCEEAKQKQdzcCCEEAIAhBCGo2Aph3QQAgAjYClHdBACAGNgKQd0EAQQA2Apx3IAhBGGohAANAIABBBzYCBCAAQQhqIQYgAEEEaiEAIAUgBksNAAsgCCAERg0DIAggCCgCBEF+cTYCBCAEIAggBGsiAkEBcjYCBCAIIAI2AgACQCACQf8BSw0AIAJBA3YiBUEDdEH48wBqIQACQAJAQQAoAtBzIgZBASAFdCIFcQ0AQQAgBiAFcjYC0HMgACEFDAELIAAoAgghBQsgACAENgIIIAUgBDYCDCAEIAA2AgwgBCAFNgIIDAQLQR8hAAJAIAJB////B0sNACACQQh2IgAgAEGA/j9qQRB2QQhxIgB0IgUgBUGA4B9qQRB2QQRxIgV0IgYgBkGAgA9qQRB2QQJxIgZ0QQ92IAAgBXIgBnJrIgBBAXQgAiAAQRVqdkEBcXJBHGohAAsgBEIANwIQIARBHGogADYCACAAQQJ0QYD2AGohBQJAAkBBACgC1HMiBkEBIAB0IghxDQBBACAGIAhyNgLUcyAFIAQ2AgAgBEEYaiAFNgIADAELIAJBAEEZIABBAXZrIABBH0YbdCEAIAUoAgAhBgNAIAYiBSgCBEF4cSACRg0EIABBHXYhBiAAQQF0IQAgBSAGQQRxakEQaiIIKAIAIgYNAAsgCCAENgIAIARBGGogBTYCAAsgBCAENgIMIAQgBDYCCAwDCyAEKAIIIgAgAzYCDCAEIAM2AgggA0EANgIYIAMgBDYCDCADIAA2AggLIAtBCGohAAwFCyAFKAIIIgAgBDYCDCAFIAQ2AgggBEEYakEANgIAIAQgBTYCDCAEIAA2AggLQQAoAtxzIgAgA00NAEEAIAAgA2siBDYC3HNBAEEAKALocyIAIANqIgU2AuhzIAUgBEEBcjYCBCAAIANBA3I2AgQgAEEIaiEADAMLEOUBQTA2AgBBACEADAILAkAgC0UNAAJAAkAgCCAIKAIcIgVBAnRBgPYAaiIAKAIARw0AIAAgBjYCACAGDQFBACAHQX4gBXdxIgc2AtRzDAILIAtBEEEUIAsoAhAgCEYbaiAGNgIAIAZFDQELIAYgCzYCGAJAIAgoAhAiAEUNACAGIAA2AhAgACAGNgIYCyAIQRRqKAIAIgBFDQAgBkEUaiAANgIAIAAgBjYCGAsCQAJAIARBD0sNACAIIAQgA2oiAEEDcjYCBCAIIABqIgAgACgCBEEBcjYCBAwBCyAIIANBA3I2AgQgCCADaiIGIARBAXI2AgQgBiAEaiAENgIAAkAgBEH/AUsNACAEQQN2IgRBA3RB+PMAaiEAAkACQEEAKALQcyIFQQEgBHQiBHENAEEAIAUgBHI2AtBzIAAhBAwBCyAAKAIIIQQLIAAgBjYCCCAEIAY2AgwgBiAANgIMIAYgBDYCCAwBC0EfIQACQCAEQf///wdLDQAgBEEIdiIAIABBgP4/akEQdkEIcSIAdCIFIAVBgOAfakEQdkEEcSIFdCIDIANBgIAPakEQdkECcSIDdEEPdiAAIAVyIANyayIAQQF0IAQgAEEVanZBAXFyQRxqIQALIAYgADYCHCAGQgA3AhAgAEECdEGA9gBqIQUCQAJAAkAgB0EBIAB0IgNxDQBBACAHIANyNgLUcyAFIAY2AgAgBiAFNgIYDAELIARBAEEZIABBAXZrIABBH0YbdCEAIAUoAgAhAwNAIAMiBSgCBEF4cSAERg0CIABBHXYhAyAAQQF0IQAgBSADQQRxakEQaiICKAIAIgMNAAsgAiAGNgIAIAYgBTYCGAsgBiAGNgIMIAYgBjYCCAwBCyAFKAIIIgAgBjYCDCAFIAY2AgggBkEANgIYIAYgBTYCDCAGIAA2AggLIAhBCGohAAwBCwJAIApFDQACQAJAIAYgBigCHCIFQQJ0QYD2AGoiACgCAEcNACAAIAg2AgAgCA0BQQAgCUF+IAV3cTYC1HMMAgsgCkEQQRQgCigCECAGRhtqIAg2AgAgCEUNAQsgCCAKNgIYAkAgBigCECIARQ0AIAggADYCECAAIAg2AhgLIAZBFGooAgAiAEUNACAIQRRqIAA2AgAgACAINgIYCwJAAkAgBEEPSw0AIAYgBCADaiIAQQNyNgIEIAYgAGoiACAAKAIEQQFyNgIEDAELIAYgA0EDcjYCBCAGIANqIgUgBEEBcjYCBCAFIARqIAQ2AgACQCAHRQ0AIAdBA3YiCEEDdEH48wBqIQNBACgC5HMhAAJAAkBBASAIdCIIIAJxDQBBACAIIAJyNgLQcyADIQgMAQsgAygCCCEICyADIAA2AgggCCAANgIMIAAgAzYCDCAAIAg2AggLQQAgBTYC5HNBACAENgLYcwsgBkEIaiEACyABQRBqJAAgAAv8DAEHfwJAIABFDQAgAEF4aiIBIABBfGooAgAiAkF4cSIAaiEDAkAgAkEBcQ0AIAJBA3FFDQEgASABKAIAIgJrIgFBACgC4HMiBEkNASACIABqIQACQEEAKALkcyABRg0AAkAgAkH/AUsNACABKAIIIgQgAkEDdiIFQQN0QfjzAGoiBkYaAkAgASgCDCICIARHDQBBAEEAKALQc0F+IAV3cTYC0HMMAwsgAiAGRhogBCACNgIMIAIgBDYCCAwCCyABKAIYIQcCQAJAIAEoAgwiBiABRg0AIAQgASgCCCICSxogAiAGNgIMIAYgAjYCCAwBCwJAIAFBFGoiAigCACIEDQAgAUEQaiICKAIAIgQNAEEAIQYMAQsDQCACIQUgBCIGQRRqIgIoAgAiBA0AIAZBEGohAiAGKAIQIgQNAAsgBUEANgIACyAHRQ0BAkACQCABKAIcIgRBAnRBgPYAaiICKAIAIAFHDQAgAiAGNgIAIAYNAUEAQQAoAtRzQX4gBHdxNgLUcwwDCyAHQRBBFCAHKAIQIAFGG2ogBjYCACAGRQ0CCyAGIAc2AhgCQCABKAIQIgJFDQAgBiACNgIQIAIgBjYCGAsgASgCFCICRQ0BIAZBFGogAjYCACACIAY2AhgMAQsgAygCBCICQQNxQQNHDQBBACAANgLYcyADIAJBfnE2AgQgASAAQQFyNgIEIAEgAGogADYCAA8LIAMgAU0NACADKAIEIgJBAXFFDQACQAJAIAJBAnENAAJAQQAoAuhzIANHDQBBACABNgLoc0EAQQAoAtxzIABqIgA2AtxzIAEgAEEBcjYCBCABQQAoAuRzRw0DQQBBADYC2HNBAEEANgLkcw8LAkBBACgC5HMgA0cNAEEAIAE2AuRzQQBBACgC2HMgAGoiADYC2HMgASAAQQFyNgIEIAEgAGogADYCAA8LIAJBeHEgAGohAAJAAkAgAkH/AUsNACADKAIIIgQgAkEDdiIFQQN0QfjzAGoiBkYaAkAgAygCDCICIARHDQBBAEEAKALQc0F+IAV3cTYC0HMMAgsgAiAGRhogBCACNgIMIAIgBDYCCAwBCyADKAIYIQcCQAJAIAMoAgwiBiADRg0AQQAoAuBzIAMoAggiAksaIAIgBjYCDCAGIAI2AggMAQsCQCADQRRqIgIoAgAiBA0AIANBEGoiAigCACIEDQBBACEGDAELA0AgAiEFIAQiBkEUaiICKAIAIgQNACAGQRBqIQIgBigCECIEDQALIAVBADYCAAsgB0UNAAJAAkAgAygCHCIEQQJ0QYD2AGoiAigCACADRw0AIAIgBjYCACAGDQFBAEEAKALUc0F+IAR3cTYC1HMMAgsgB0EQQRQgBygCECADRhtqIAY2AgAgBkUNAQsgBiAHNgIYAkAgAygCECICRQ0AIAYgAjYCECACIAY2AhgLIAMoAhQiAkUNACAGQRRqIAI2AgAgAiAGNgIYCyABIABBAXI2AgQgASAAaiAANgIAIAFBACgC5HNHDQFBACAANgLYcw8LIAMgAkF+cTYCBCABIABBAXI2AgQgASAAaiAANgIACwJAIABB/wFLDQAgAEEDdiICQQN0QfjzAGohAAJAAkBBACgC0HMiBEEBIAJ0IgJxDQBBACAEIAJyNgLQcyAAIQIMAQsgACgCCCECCyAAIAE2AgggAiABNgIMIAEgADYCDCABIAI2AggPC0EfIQICQCAAQf///wdLDQAgAEEIdiICIAJBgP4/akEQdkEIcSICdCIEIARBgOAfakEQdkEEcSIEdCIGIAZBgIAPakEQdkECcSIGdEEPdiACIARyIAZyayICQQF0IAAgAkEVanZBAXFyQRxqIQILIAFCADcCECABQRxqIAI2AgAgAkECdEGA9gBqIQQCQAJAAkACQEEAKALUcyIGQQEgAnQiA3ENAEEAIAYgA3I2AtRzIAQgATYCACABQRhqIAQ2AgAMAQsgAEEAQRkgAkEBdmsgAkEfRht0IQIgBCgCACEGA0AgBiIEKAIEQXhxIABGDQIgAkEddiEGIAJBAXQhAiAEIAZBBHFqQRBqIgMoAgAiBg0ACyADIAE2AgAgAUEYaiAENgIACyABIAE2AgwgASABNgIIDAELIAQoAggiACABNgIMIAQgATYCCCABQRhqQQA2AgAgASAENgIMIAEgADYCCAtBAEEAKALwc0F/aiIBQX8gARs2AvBzCwuMAQECfwJAIAANACABEPkBDwsCQCABQUBJDQAQ5QFBMDYCAEEADwsCQCAAQXhqQRAgAUELakF4cSABQQtJGxD8ASICRQ0AIAJBCGoPCwJAIAEQ+QEiAg0AQQAPCyACIABBfEF4IABBfGooAgAiA0EDcRsgA0F4cWoiAyABIAMgAUkbEL8BGiAAEPoBIAILvwcBCX8gACgCBCICQXhxIQMCQAJAIAJBA3ENAAJAIAFBgAJPDQBBAA8LAkAgAyABQQRqSQ0AIAAhBCADIAFrQQAoArB3QQF0TQ0CC0EADwsgACADaiEFAkACQCADIAFJDQAgAyABayIDQRBJDQEgACACQQFxIAFyQQJyNgIEIAAgAWoiASADQQNyNgIEIAUgBSgCBEEBcjYCBCABIAMQ/QEMAQtBACEEAkBBACgC6HMgBUcNAEEAKALccyADaiIDIAFNDQIgACACQQFxIAFyQQJyNgIEIAAgAWoiAiADIAFrIgFBAXI2AgRBACABNgLcc0EAIAI2AuhzDAELAkBBACgC5HMgBUcNAEEAIQRBACgC2HMgA2oiAyABSQ0CAkACQCADIAFrIgRBEEkNACAAIAJBAXEgAXJBAnI2AgQgACABaiIBIARBAXI2AgQgACADaiIDIAQ2AgAgAyADKAIEQX5xNgIEDAELIAAgAkEBcSADckECcjYCBCAAIANqIgEgASgCBEEBcjYCBEEAIQRBACEBC0EAIAE2AuRzQQAgBDYC2HMMAQtBACEEIAUoAgQiBkECcQ0BIAZBeHEgA2oiByABSQ0BIAcgAWshCAJAAkAgBkH/AUsNACAFKAIIIgMgBkEDdiIJQQN0QfjzAGoiBkYaAkAgBSgCDCIEIANHDQBBAEEAKALQc0F+IAl3cTYC0HMMAgsgBCAGRhogAyAENgIMIAQgAzYCCAwBCyAFKAIYIQoCQAJAIAUoAgwiBiAFRg0AQQAoAuBzIAUoAggiA0saIAMgBjYCDCAGIAM2AggMAQsCQCAFQRRqIgMoAgAiBA0AIAVBEGoiAygCACIEDQBBACEGDAELA0AgAyEJIAQiBkEUaiIDKAIAIgQNACAGQRBqIQMgBigCECIEDQALIAlBADYCAAsgCkUNAAJAAkAgBSgCHCIEQQJ0QYD2AGoiAygCACAFRw0AIAMgBjYCACAGDQFBAEEAKALUc0F+IAR3cTYC1HMMAgsgCkEQQRQgCigCECAFRhtqIAY2AgAgBkUNAQsgBiAKNgIYAkAgBSgCECIDRQ0AIAYgAzYCECADIAY2AhgLIAUoAhQiA0UNACAGQRRqIAM2AgAgAyAGNgIYCwJAIAhBD0sNACAAIAJBAXEgB3JBAnI2AgQgACAHaiIBIAEoAgRBAXI2AgQMAQsgACACQQFxIAFyQQJyNgIEIAAgAWoiASAIQQNyNgIEIAAgB2oiAyADKAIEQQFyNgIEIAEgCBD9AQsgACEECyAEC7MMAQZ/IAAgAWohAgJAAkAgACgCBCIDQQFxDQAgA0EDcUUNASAAKAIAIgMgAWohAQJAAkBBACgC5HMgACADayIARg0AAkAgA0H/AUsNACAAKAIIIgQgA0EDdiIFQQN0QfjzAGoiBkYaIAAoAgwiAyAERw0CQQBBACgC0HNBfiAFd3E2AtBzDAMLIAAoAhghBwJAAkAgACgCDCIGIABGDQBBACgC4HMgACgCCCIDSxogAyAGNgIMIAYgAzYCCAwBCwJAIABBFGoiAygCACIEDQAgAEEQaiIDKAIAIgQNAEEAIQYMAQsDQCADIQUgBCIGQRRqIgMoAgAiBA0AIAZBEGohAyAGKAIQIgQNAAsgBUEANgIACyAHRQ0CAkACQCAAKAIcIgRBAnRBgPYAaiIDKAIAIABHDQAgAyAGNgIAIAYNAUEAQQAoAtRzQX4gBHdxNgLUcwwECyAHQRBBFCAHKAIQIABGG2ogBjYCACAGRQ0DCyAGIAc2AhgCQCAAKAIQIgNFDQAgBiADNgIQIAMgBjYCGAsgACgCFCIDRQ0CIAZBFGogAzYCACADIAY2AhgMAgsgAigCBCIDQQNxQQNHDQFBACABNgLYcyACIANBfnE2AgQgACABQQFyNgIEIAIgATYCAA8LIAMgBkYaIAQgAzYCDCADIAQ2AggLAkACQCACKAIEIgNBAnENAAJAQQAoAuhzIAJHDQBBACAANgLoc0EAQQAoAtxzIAFqIgE2AtxzIAAgAUEBcjYCBCAAQQAoAuRzRw0DQQBBADYC2HNBAEEANgLkcw8LAkBBACgC5HMgAkcNAEEAIAA2AuRzQQBBACgC2HMgAWoiATYC2HMgACABQQFyNgIEIAAgAWogATYCAA8LIANBeHEgAWohAQJAAkAgA0H/AUsNACACKAIIIgQgA0EDdiIFQQN0QfjzAGoiBkYaAkAgAigCDCIDIARHDQBBAEEAKALQc0F+IAV3cTYC0HMMAgsgAyAGRhogBCADNgIMIAMgBDYCCAwBCyACKAIYIQcCQAJAIAIoAgwiBiACRg0AQQAoAuBzIAIoAggiA0saIAMgBjYCDCAGIAM2AggMAQsCQCACQRRqIgQoAgAiAw0AIAJBEGoiBCgCACIDDQBBACEGDAELA0AgBCEFIAMiBkEUaiIEKAIAIgMNACAGQRBqIQQgBigCECIDDQALIAVBADYCAAsgB0UNAAJAAkAgAigCHCIEQQJ0QYD2AGoiAygCACACRw0AIAMgBjYCACAGDQFBAEEAKALUc0F+IAR3cTYC1HMMAgsgB0EQQRQgBygCECACRhtqIAY2AgAgBkUNAQsgBiAHNgIYAkAgAigCECIDRQ0AIAYgAzYCECADIAY2AhgLIAIoAhQiA0UNACAGQRRqIAM2AgAgAyAGNgIYCyAAIAFBAXI2AgQgACABaiABNgIAIABBACgC5HNHDQFBACABNgLYcw8LIAIgA0F+cTYCBCAAIAFBAXI2AgQgACABaiABNgIACwJAIAFB/wFLDQAgAUEDdiIDQQN0QfjzAGohAQJAAkBBACgC0HMiBEEBIAN0IgNxDQBBACAEIANyNgLQcyABIQMMAQsgASgCCCEDCyABIAA2AgggAyAANgIMIAAgATYCDCAAIAM2AggPC0EfIQMCQCABQf///wdLDQAgAUEIdiIDIANBgP4/akEQdkEIcSIDdCIEIARBgOAfakEQdkEEcSIEdCIGIAZBgIAPakEQdkECcSIGdEEPdiADIARyIAZyayIDQQF0IAEgA0EVanZBAXFyQRxqIQMLIABCADcCECAAQRxqIAM2AgAgA0ECdEGA9gBqIQQCQAJAAkBBACgC1HMiBkEBIAN0IgJxDQBBACAGIAJyNgLUcyAEIAA2AgAgAEEYaiAENgIADAELIAFBAEEZIANBAXZrIANBH0YbdCEDIAQoAgAhBgNAIAYiBCgCBEF4cSABRg0CIANBHXYhBiADQQF0IQMgBCAGQQRxakEQaiICKAIAIgYNAAsgAiAANgIAIABBGGogBDYCAAsgACAANgIMIAAgADYCCA8LIAQoAggiASAANgIMIAQgADYCCCAAQRhqQQA2AgAgACAENgIMIAAgATYCCAsLZQIBfwF+AkACQCAADQBBACECDAELIACtIAGtfiIDpyECIAEgAHJBgIAESQ0AQX8gAiADQiCIp0EARxshAgsCQCACEPkBIgBFDQAgAEF8ai0AAEEDcUUNACAAQQAgAhDWARoLIAALBwA/AEEQdAtSAQJ/QQAoAphyIgEgAEEDakF8cSICaiEAAkACQCACRQ0AIAAgAU0NAQsCQCAAEP8BTQ0AIAAQBEUNAQtBACAANgKYciABDwsQ5QFBMDYCAEF/C1MBAX4CQAJAIANBwABxRQ0AIAEgA0FAaq2GIQJCACEBDAELIANFDQAgAUHAACADa62IIAIgA60iBIaEIQIgASAEhiEBCyAAIAE3AwAgACACNwMIC1MBAX4CQAJAIANBwABxRQ0AIAIgA0FAaq2IIQFCACECDAELIANFDQAgAkHAACADa62GIAEgA60iBIiEIQEgAiAEiCECCyAAIAE3AwAgACACNwMIC+oDAgJ/An4jAEEgayICJAACQAJAIAFC////////////AIMiBEKAgICAgIDA/0N8IARCgICAgICAwIC8f3xaDQAgAEI8iCABQgSGhCEEAkAgAEL//////////w+DIgBCgYCAgICAgIAIVA0AIARCgYCAgICAgIDAAHwhBQwCCyAEQoCAgICAgICAwAB8IQUgAEKAgICAgICAgAiFQgBSDQEgBSAEQgGDfCEFDAELAkAgAFAgBEKAgICAgIDA//8AVCAEQoCAgICAgMD//wBRGw0AIABCPIggAUIEhoRC/////////wODQoCAgICAgID8/wCEIQUMAQtCgICAgICAgPj/ACEFIARC////////v//DAFYNAEIAIQUgBEIwiKciA0GR9wBJDQAgAkEQaiAAIAFC////////P4NCgICAgICAwACEIgQgA0H/iH9qEIECIAIgACAEQYH4ACADaxCCAiACKQMAIgRCPIggAkEIaikDAEIEhoQhBQJAIARC//////////8PgyACKQMQIAJBEGpBCGopAwCEQgBSrYQiBEKBgICAgICAgAhUDQAgBUIBfCEFDAELIARCgICAgICAgIAIhUIAUg0AIAVCAYMgBXwhBQsgAkEgaiQAIAUgAUKAgICAgICAgIB/g4S/CwQAIwALBgAgACQACxIBAn8jACAAa0FwcSIBJAAgAQsNACABIAIgAyAAEREACyQBAX4gACABIAKtIAOtQiCGhCAEEIcCIQUgBUIgiKcQBSAFpwsTACAAIAGnIAFCIIinIAIgAxAGCwus6oCAAAIAQYAIC8Boc2hhcGUtPmJvZHkAIXN0YXRpY0luZGV4LT5keW5hbWljSW5kZXgALSsgICAwWDB4AC0wWCswWCAwWC0weCsweCAweABUcmllZCB0byByZXNpemUgYSBoYXNoIHRhYmxlIHRvIGEgc2l6ZSBncmVhdGVyIHRoYW4gMTYxMDYxMjc0MSBPX28AbmFuAC93b3JrL3cvc2IvLmNyb3NzY2hlY2tfMXgzNzBiNngucGFydC9weW11bmstNy4zLjEvTXVuazJEL3NyYy9wcmltZS5oAGluZgBtb21lbnQgPj0gMC4wZgBlcnJvckJpYXMgPj0gMC4wZgBmcmljdGlvbiA+PSAwLjBmAGNwRmFsc2UAIWJvZHktPnNwYWNlACFjb25zdHJhaW50LT5zcGFjZQAhc2hhcGUtPnNwYWNlAHNoYXBlLT5ib2R5LT5zcGFjZSA9PSBzcGFjZQBib2R5LT5zcGFjZSAhPSBzcGFjZQBjb25zdHJhaW50LT5zcGFjZSAhPSBzcGFjZQBzaGFwZS0+c3BhY2UgIT0gc3BhY2UAIXNwYWNlLT5sb2NrZWQAL3dvcmsvdy9zYi8uY3Jvc3NjaGVja18xeDM3MGI2eC5wYXJ0L3B5bXVuay03LjMuMS9NdW5rMkQvc3JjL2NwQm9keS5jAC93b3JrL3cvc2IvLmNyb3NzY2hlY2tfMXgzNzBiNngucGFydC9weW11bmstNy4zLjEvTXVuazJEL3NyYy9jcFNwYXRpYWxJbmRleC5jAC93b3JrL3cvc2IvLmNyb3NzY2hlY2tfMXgzNzBiNngucGFydC9weW11bmstNy4zLjEvTXVuazJEL3NyYy9jcEdyb292ZUpvaW50LmMAL3dvcmsvdy9zYi8uY3Jvc3NjaGVja18xeDM3MGI2eC5wYXJ0L3B5bXVuay03LjMuMS9NdW5rMkQvc3JjL2NwQ29uc3RyYWludC5jAC93b3JrL3cvc2IvLmNyb3NzY2hlY2tfMXgzNzBiNngucGFydC9weW11bmstNy4zLjEvTXVuazJEL3NyYy9jcFNwYWNlQ29tcG9uZW50LmMAL3dvcmsvdy9zYi8uY3Jvc3NjaGVja18xeDM3MGI2eC5wYXJ0L3B5bXVuay03LjMuMS9NdW5rMkQvc3JjL2NwU3BhY2VTdGVwLmMAL3dvcmsvdy9zYi8uY3Jvc3NjaGVja18xeDM3MGI2eC5wYXJ0L3B5bXVuay03LjMuMS9NdW5rMkQvc3JjL2NwQ29sbGlzaW9uLmMAL3dvcmsvdy9zYi8uY3Jvc3NjaGVja18xeDM3MGI2eC5wYXJ0L3B5bXVuay03LjMuMS9NdW5rMkQvc3JjL2NwU2hhcGUuYwAvd29yay93L3NiLy5jcm9zc2NoZWNrXzF4MzcwYjZ4LnBhcnQvcHltdW5rLTcuMy4xL011bmsyRC9zcmMvY3BTcGFjZS5jAHByaW1lc1tpXQAwLjBmIDw9IG1hc3MgJiYgbWFzcyA8IElORklOSVRZAGNvdW50IDw9IENQX01BWF9DT05UQUNUU19QRVJfQVJCSVRFUgBOQU4Ac3BhY2UtPnN0YXRpY0JvZHktPnNoYXBlTGlzdCA9PSBOVUxMAGEgIT0gTlVMTCAmJiBiICE9IE5VTEwASU5GAGNwQm9keUdldFR5cGUoYm9keSkgPT0gQ1BfQk9EWV9UWVBFX1NUQVRJQwBjcEJvZHlHZXRUeXBlKGJvZHkpID09IENQX0JPRFlfVFlQRV9EWU5BTUlDAGl0ZXJhdGlvbnMgPiAwAHNwYWNlLT5sb2NrZWQgPj0gMABjcEJvZHlBY3RpdmF0ZVN0YXRpYygpIGNhbGxlZCBvbiBhIG5vbi1zdGF0aWMgYm9keS4ASW50ZXJuYWwgZXJyb3I6IEF0dGVtcHRpbmcgdG8gZGVhY3RpdmF0ZSBhIG5vbi1keW5hbWljIGJvZHkuAEludGVybmFsIGVycm9yOiBBdHRlbXB0aW5nIHRvIGFjdGl2YXRlIGEgbm9uLWR5bmFtaWMgYm9keS4AQ29uc3RyYWludCBpcyBhdHRhY2hlZCB0byBhIE5VTEwgYm9keS4AVGhpcyBzdGF0aWMgaW5kZXggaXMgYWxyZWFkeSBhc3NvY2lhdGVkIHdpdGggYSBkeW5hbWljIGluZGV4LgBJbnRlcm5hbCBFcnJvcjogU3BhY2UgbG9jayB1bmRlcmZsb3cuAENvbnN0cmFpbnQgaXMgbm90IGEgZ3Jvb3ZlIGpvaW50LgBZb3UgY2Fubm90IHNldCB0aGUgbWFzcyBvZiBraW5lbWF0aWMgb3Igc3RhdGljIGJvZGllcy4ASXRlcmF0aW9ucyBtdXN0IGJlIHBvc2l0aXZlIGFuZCBub24temVyby4AVGhpcyBvcGVyYXRpb24gY2Fubm90IGJlIGRvbmUgc2FmZWx5IGR1cmluZyBhIGNhbGwgdG8gY3BTcGFjZVN0ZXAoKSBvciBkdXJpbmcgYSBxdWVyeS4gUHV0IHRoZXNlIGNhbGxzIGludG8gYSBwb3N0LXN0ZXAgY2FsbGJhY2suAGVycm9yQmlhcyBtdXN0IGJlIHBvc2l0aXZlLgBGcmljdGlvbiBtdXN0IGJlIHBvc2l0aXZlLgBNb21lbnQgb2YgSW5lcnRpYSBtdXN0IGJlIHBvc2l0aXZlLgBNYXNzIG11c3QgYmUgcG9zaXRpdmUgYW5kIGZpbml0ZS4AVGhlIHNoYXBlJ3MgYm9keSBtdXN0IGJlIGFkZGVkIHRvIHRoZSBzcGFjZSBiZWZvcmUgdGhlIHNoYXBlLgBZb3UgaGF2ZSBhbHJlYWR5IGFkZGVkIHRoaXMgYm9keSB0byB0aGlzIHNwYWNlLiBZb3UgbXVzdCBub3QgYWRkIGl0IGEgc2Vjb25kIHRpbWUuAFlvdSBoYXZlIGFscmVhZHkgYWRkZWQgdGhpcyBjb25zdHJhaW50IHRvIHRoaXMgc3BhY2UuIFlvdSBtdXN0IG5vdCBhZGQgaXQgYSBzZWNvbmQgdGltZS4AWW91IGhhdmUgYWxyZWFkeSBhZGRlZCB0aGlzIHNoYXBlIHRvIHRoaXMgc3BhY2UuIFlvdSBtdXN0IG5vdCBhZGQgaXQgYSBzZWNvbmQgdGltZS4AQ2Fubm90IHJlbW92ZSB0aGUgZGVzaWduYXRlZCBzdGF0aWMgYm9keSBmb3IgdGhlIHNwYWNlLgBZb3UgaGF2ZSBhbHJlYWR5IGFkZGVkIHRoaXMgYm9keSB0byBhbm90aGVyIHNwYWNlLiBZb3UgY2Fubm90IGFkZCBpdCB0byBhIHNlY29uZC4AWW91IGhhdmUgYWxyZWFkeSBhZGRlZCB0aGlzIGNvbnN0cmFpbnQgdG8gYW5vdGhlciBzcGFjZS4gWW91IGNhbm5vdCBhZGQgaXQgdG8gYSBzZWNvbmQuAFlvdSBoYXZlIGFscmVhZHkgYWRkZWQgdGhpcyBzaGFwZSB0byBhbm90aGVyIHNwYWNlLiBZb3UgY2Fubm90IGFkZCBpdCB0byBhIHNlY29uZC4ASW50ZXJuYWwgRXJyb3I6IFNoYXBlIHR5cGVzIGFyZSBub3Qgc29ydGVkLgBUaGUgc2hhcGUncyBib2R5IGlzIG5vdCBkZWZpbmVkLgBJbnRlcm5hbCBFcnJvcjogQ2hhbmdpbmcgdGhlIGRlc2lnbmF0ZWQgc3RhdGljIGJvZHkgd2hpbGUgdGhlIG9sZCBvbmUgc3RpbGwgaGFkIHNoYXBlcyBhdHRhY2hlZC4AY3BTcGFjZUNvbnRhaW5zQm9keShzcGFjZSwgYm9keSkAY3BDb25zdHJhaW50SXNHcm9vdmVKb2ludChjb25zdHJhaW50KQBjcFNwYWNlQ29udGFpbnNDb25zdHJhaW50KHNwYWNlLCBjb25zdHJhaW50KQAobnVsbCkAY3BTcGFjZUNvbnRhaW5zU2hhcGUoc3BhY2UsIHNoYXBlKQBib2R5ICE9IGNwU3BhY2VHZXRTdGF0aWNCb2R5KHNwYWNlKQBDYW5ub3QgcmVtb3ZlIGEgYm9keSB0aGF0IHdhcyBub3QgYWRkZWQgdG8gdGhlIHNwYWNlLiAoUmVtb3ZlZCB0d2ljZSBtYXliZT8pAENhbm5vdCByZW1vdmUgYSBjb25zdHJhaW50IHRoYXQgd2FzIG5vdCBhZGRlZCB0byB0aGUgc3BhY2UuIChSZW1vdmVkIHR3aWNlIG1heWJlPykAQ2Fubm90IHJlbW92ZSBhIHNoYXBlIHRoYXQgd2FzIG5vdCBhZGRlZCB0byB0aGUgc3BhY2UuIChSZW1vdmVkIHR3aWNlIG1heWJlPykASW50ZXJuYWwgRXJyb3I6IENvbnRhY3QgYnVmZmVyIG92ZXJmbG93IQBBYm9ydGluZyBkdWUgdG8gQ2hpcG11bmsgZXJyb3I6IABDaGlwbXVuayB3YXJuaW5nOiAACUZhaWxlZCBjb25kaXRpb246ICVzCgAJU291cmNlOiVzOiVkCgAAAAAAAAAAAAAXAAAAGAAAABgAAAAZAAAAGgAAABgAAAAbAAAAHAAAAB0AAAAeAAAAHwAAACAAAAAhAAAAAAAAAAAAAAAAAAAABQAAAA0AAAAXAAAALwAAAGEAAADBAAAAhQEAAAEDAAAHBgAABwwAAAcYAAABMAAAEWAAAAXAAAANgAEABQADABkABgABAAwABQAYAAsAMAANAGAABQDAABMAgAEFAAADFwAABhMAAAwFAAAYWQAAMAUAAGAAAAAAIgAAACMAAAAkAAAAJQAAAAIAAAAmAAAAJwAAACgAAAApAAAAAAAAACoAAAAAAAAAKwAAACwAAAABAAAALQAAAAAAAAAuAAAALwAAAAAAAAAAAAAAAAAAAAMAAAAEAAAABAAAAAYAAACD+aIARE5uAPwpFQDRVycA3TT1AGLbwAA8mZUAQZBDAGNR/gC73qsAt2HFADpuJADSTUIASQbgAAnqLgAcktEA6x3+ACmxHADoPqcA9TWCAES7LgCc6YQAtCZwAEF+XwDWkTkAU4M5AJz0OQCLX4QAKPm9APgfOwDe/5cAD5gFABEv7wAKWosAbR9tAM9+NgAJyycARk+3AJ5mPwAt6l8Auid1AOXrxwA9e/EA9zkHAJJSigD7a+oAH7FfAAhdjQAwA1YAe/xGAPCrawAgvM8ANvSaAOOpHQBeYZEACBvmAIWZZQCgFF8AjUBoAIDY/wAnc00ABgYxAMpWFQDJqHMAe+JgAGuMwAAZxEcAzWfDAAno3ABZgyoAi3bEAKYclgBEr90AGVfRAKU+BQAFB/8AM34/AMIy6ACYT94Au30yACY9wwAea+8An/heADUfOgB/8soA8YcdAHyQIQBqJHwA1W76ADAtdwAVO0MAtRTGAMMZnQCtxMIALE1BAAwAXQCGfUYA43EtAJvGmgAzYgAAtNJ8ALSnlwA3VdUA1z72AKMQGABNdvwAZJ0qAHDXqwBjfPgAerBXABcV5wDASVYAO9bZAKeEOAAkI8sA1op3AFpUIwAAH7kA8QobABnO3wCfMf8AZh5qAJlXYQCs+0cAfn/YACJltwAy6IkA5r9gAO/EzQBsNgkAXT/UABbe1wBYO94A3puSANIiKAAohugA4lhNAMbKMgAI4xYA4H3LABfAUADzHacAGOBbAC4TNACDEmIAg0gBAPWOWwCtsH8AHunyAEhKQwAQZ9MAqt3YAK5fQgBqYc4ACiikANOZtAAGpvIAXHd/AKPCgwBhPIgAinN4AK+MWgBv170ALaZjAPS/ywCNge8AJsFnAFXKRQDK2TYAKKjSAMJhjQASyXcABCYUABJGmwDEWcQAyMVEAE2ykQAAF/MA1EOtAClJ5QD91RAAAL78AB6UzABwzu4AEz71AOzxgACz58MAx/goAJMFlADBcT4ALgmzAAtF8wCIEpwAqyB7AC61nwBHksIAezIvAAxVbQByp5AAa+cfADHLlgB5FkoAQXniAPTfiQDolJcA4uaEAJkxlwCI7WsAX182ALv9DgBImrQAZ6RsAHFyQgCNXTIAnxW4ALzlCQCNMSUA93Q5ADAFHAANDAEASwhoACzuWABHqpAAdOcCAL3WJAD3faYAbkhyAJ8W7wCOlKYAtJH2ANFTUQDPCvIAIJgzAPVLfgCyY2gA3T5fAEBdAwCFiX8AVVIpADdkwABt2BAAMkgyAFtMdQBOcdQARVRuAAsJwQAq9WkAFGbVACcHnQBdBFAAtDvbAOp2xQCH+RcASWt9AB0nugCWaSkAxsysAK0UVACQ4moAiNmJACxyUAAEpL4AdweUAPMwcAAA/CcA6nGoAGbCSQBk4D0Al92DAKM/lwBDlP0ADYaMADFB3gCSOZ0A3XCMABe35wAI3zsAFTcrAFyAoABagJMAEBGSAA/o2ABsgK8A2/9LADiQDwBZGHYAYqUVAGHLuwDHibkAEEC9ANLyBABJdScA67b2ANsiuwAKFKoAiSYvAGSDdgAJOzMADpQaAFE6qgAdo8IAr+2uAFwmEgBtwk0ALXqcAMBWlwADP4MACfD2ACtAjABtMZkAObQHAAwgFQDYw1sA9ZLEAMatSwBOyqUApzfNAOapNgCrkpQA3UJoABlj3gB2jO8AaItSAPzbNwCuoasA3xUxAACuoQAM+9oAZE1mAO0FtwApZTAAV1a/AEf/OgBq+bkAdb7zACiT3wCrgDAAZoz2AATLFQD6IgYA2eQdAD2zpABXG48ANs0JAE5C6QATvqQAMyO1APCqGgBPZagA0sGlAAs/DwBbeM0AI/l2AHuLBACJF3IAxqZTAG9u4gDv6wAAm0pYAMTatwCqZroAds/PANECHQCx8S0AjJnBAMOtdwCGSNoA912gAMaA9ACs8C8A3eyaAD9cvADQ3m0AkMcfACrbtgCjJToAAK+aAK1TkwC2VwQAKS20AEuAfgDaB6cAdqoOAHtZoQAWEioA3LctAPrl/QCJ2/4Aib79AOR2bAAGqfwAPoBwAIVuFQD9h/8AKD4HAGFnMwAqGIYATb3qALPnrwCPbW4AlWc5ADG/WwCE10gAMN8WAMctQwAlYTUAyXDOADDLuAC/bP0ApACiAAVs5ABa3aAAIW9HAGIS0gC5XIQAcGFJAGtW4ACZUgEAUFU3AB7VtwAz8cQAE25fAF0w5ACFLqkAHbLDAKEyNgAIt6QA6rHUABb3IQCPaeQAJ/93AAwDgACNQC0AT82gACClmQCzotMAL10KALT5QgAR2ssAfb7QAJvbwQCrF70AyqKBAAhqXAAuVRcAJwBVAH8U8ADhB4YAFAtkAJZBjQCHvt4A2v0qAGsltgB7iTQABfP+ALm/ngBoak8ASiqoAE/EWgAt+LwA11qYAPTHlQANTY0AIDqmAKRXXwAUP7EAgDiVAMwgAQBx3YYAyd62AL9g9QBNZREAAQdrAIywrACywNAAUVVIAB77DgCVcsMAowY7AMBANQAG3HsA4EXMAE4p+gDWysgA6PNBAHxk3gCbZNgA2b4xAKSXwwB3WNQAaePFAPDaEwC6OjwARhhGAFV1XwDSvfUAbpLGAKwuXQAORO0AHD5CAGHEhwAp/ekA59bzACJ8ygBvkTUACODFAP/XjQBuauIAsP3GAJMIwQB8XXQAa62yAM1unQA+cnsAxhFqAPfPqQApc98Atcm6ALcAUQDisg0AdLokAOV9YAB02IoADRUsAIEYDAB+ZpQAASkWAJ96dgD9/b4AVkXvANl+NgDs2RMAi7q5AMSX/AAxqCcA8W7DAJTFNgDYqFYAtKi1AM/MDgASiS0Ab1c0ACxWiQCZzuMA1iC5AGteqgA+KpwAEV/MAP0LSgDh9PsAjjttAOKGLADp1IQA/LSpAO/u0QAuNckALzlhADghRAAb2cgAgfwKAPtKagAvHNgAU7SEAE6ZjABUIswAKlXcAMDG1gALGZYAGnC4AGmVZAAmWmAAP1LuAH8RDwD0tREA/Mv1ADS8LQA0vO4A6F3MAN1eYABnjpsAkjPvAMkXuABhWJsA4Ve8AFGDxgDYPhAA3XFIAC0c3QCvGKEAISxGAFnz1wDZepgAnlTAAE+G+gBWBvwA5XmuAIkiNgA4rSIAZ5PcAFXoqgCCJjgAyuebAFENpACZM7EAqdcOAGkFSABlsvAAf4inAIhMlwD50TYAIZKzAHuCSgCYzyEAQJ/cANxHVQDhdDoAZ+tCAP6d3wBe1F8Ae2ekALqsegBV9qIAK4gjAEG6VQBZbggAISqGADlHgwCJ4+YA5Z7UAEn7QAD/VukAHA/KAMVZigCU+isA08HFAA/FzwDbWq4AR8WGAIVDYgAhhjsALHmUABBhhwAqTHsAgCwaAEO/EgCIJpAAeDyJAKjE5ADl23sAxDrCACb06gD3Z4oADZK/AGWjKwA9k7EAvXwLAKRR3AAn3WMAaeHdAJqUGQCoKZUAaM4oAAnttABEnyAATpjKAHCCYwB+fCMAD7kyAKf1jgAUVucAIfEIALWdKgBvfk0ApRlRALX5qwCC39YAlt1hABY2AgDEOp8Ag6KhAHLtbQA5jXoAgripAGsyXABGJ1sAADTtANIAdwD89FUAAVlNAOBxgAAAAAAAAAAAAAAAAED7Ifk/AAAAAC1EdD4AAACAmEb4PAAAAGBRzHg7AAAAgIMb8DkAAABAICV6OAAAAIAiguM2AAAAAB3zaTX+gitlRxVnQAAAAAAAADhDAAD6/kIudr86O568mvcMvb39/////98/PFRVVVVVxT+RKxfPVVWlPxfQpGcREYE/AAAAAAAAyELvOfr+Qi7mPyTEgv+9v84/tfQM1whrrD/MUEbSq7KDP4Q6Tpvg11U/AAAAAAAAAAAAAAAAAADwP26/iBpPO5s8NTP7qT327z9d3NicE2BxvGGAdz6a7O8/0WaHEHpekLyFf27oFePvPxP2ZzVS0ow8dIUV07DZ7z/6jvkjgM6LvN723Slr0O8/YcjmYU73YDzIm3UYRcfvP5nTM1vko5A8g/PGyj6+7z9te4NdppqXPA+J+WxYte8//O/9khq1jjz3R3IrkqzvP9GcL3A9vj48otHTMuyj7z8LbpCJNANqvBvT/q9mm+8/Dr0vKlJWlbxRWxLQAZPvP1XqTozvgFC8zDFswL2K7z8W9NW5I8mRvOAtqa6agu8/r1Vc6ePTgDxRjqXImHrvP0iTpeoVG4C8e1F9PLhy7z89Mt5V8B+PvOqNjDj5au8/v1MTP4yJizx1y2/rW2PvPybrEXac2Za81FwEhOBb7z9gLzo+9+yaPKq5aDGHVO8/nTiGy4Lnj7wd2fwiUE3vP43DpkRBb4o81oxiiDtG7z99BOSwBXqAPJbcfZFJP+8/lKio4/2Oljw4YnVuejjvP31IdPIYXoc8P6ayT84x7z/y5x+YK0eAPN184mVFK+8/XghxP3u4lryBY/Xh3yTvPzGrCW3h94I84d4f9Z0e7z/6v28amyE9vJDZ2tB/GO8/tAoMcoI3izwLA+SmhRLvP4/LzomSFG48Vi8+qa8M7z+2q7BNdU2DPBW3MQr+Bu8/THSs4gFChjwx2Ez8cAHvP0r401053Y88/xZksgj87j8EW447gKOGvPGfkl/F9u4/aFBLzO1KkrzLqTo3p/HuP44tURv4B5m8ZtgFba7s7j/SNpQ+6NFxvPef5TTb5+4/FRvOsxkZmbzlqBPDLePuP21MKqdIn4U8IjQSTKbe7j+KaSh6YBKTvByArARF2u4/W4kXSI+nWLwqLvchCtbuPxuaSWebLHy8l6hQ2fXR7j8RrMJg7WNDPC2JYWAIzu4/72QGOwlmljxXAB3tQcruP3kDodrhzG480DzBtaLG7j8wEg8/jv+TPN7T1/Aqw+4/sK96u86QdjwnKjbV2r/uP3fgVOu9HZM8Dd39mbK87j+Oo3EANJSPvKcsnXayue4/SaOT3Mzeh7xCZs+i2rbuP184D73G3ni8gk+dViu07j/2XHvsRhKGvA+SXcqkse4/jtf9GAU1kzzaJ7U2R6/uPwWbii+3mHs8/ceX1BKt7j8JVBzi4WOQPClUSN0Hq+4/6sYZUIXHNDy3RlmKJqnuPzXAZCvmMpQ8SCGtFW+n7j+fdplhSuSMvAncdrnhpe4/qE3vO8UzjLyFVTqwfqTuP67pK4l4U4S8IMPMNEaj7j9YWFZ43c6TvCUiVYI4ou4/ZBl+gKoQVzxzqUzUVaHuPygiXr/vs5O8zTt/Zp6g7j+CuTSHrRJqvL/aC3USoO4/7qltuO9nY7wvGmU8sp/uP1GI4FQ93IC8hJRR+X2f7j/PPlp+ZB94vHRf7Oh1n+4/sH2LwEruhrx0gaVImp/uP4rmVR4yGYa8yWdCVuuf7j/T1Aley5yQPD9d3k9poO4/HaVNudwye7yHAetzFKHuP2vAZ1T97JQ8MsEwAe2h7j9VbNar4etlPGJOzzbzou4/Qs+zL8WhiLwSGj5UJ6TuPzQ3O/G2aZO8E85MmYml7j8e/xk6hF6AvK3HI0Yap+4/bldy2FDUlLztkkSb2ajuPwCKDltnrZA8mWaK2ceq7j+06vDBL7eNPNugKkLlrO4//+fFnGC2ZbyMRLUWMq/uP0Rf81mD9ns8NncVma6x7j+DPR6nHwmTvMb/kQtbtO4/KR5si7ipXbzlxc2wN7fuP1m5kHz5I2y8D1LIy0S67j+q+fQiQ0OSvFBO3p+Cve4/S45m12zKhby6B8pw8cDuPyfOkSv8r3E8kPCjgpHE7j+7cwrhNdJtPCMj4xljyO4/YyJiIgTFh7xl5V17ZszuP9Ux4uOGHIs8My1K7JvQ7j8Vu7zT0buRvF0lPrID1e4/0jHunDHMkDxYszATntnuP7Nac26EaYQ8v/15VWve7j+0nY6Xzd+CvHrz079r4+4/hzPLkncajDyt01qZn+juP/rZ0UqPe5C8ZraNKQfu7j+6rtxW2cNVvPsVT7ii8+4/QPamPQ6kkLw6WeWNcvnuPzSTrTj01mi8R1778nb/7j81ilhr4u6RvEoGoTCwBe8/zd1fCtf/dDzSwUuQHgzvP6yYkvr7vZG8CR7XW8IS7z+zDK8wrm5zPJxShd2bGe8/lP2fXDLjjjx60P9fqyDvP6xZCdGP4IQ8S9FXLvEn7z9nGk44r81jPLXnBpRtL+8/aBmSbCxrZzxpkO/cIDfvP9K1zIMYioC8+sNdVQs/7z9v+v8/Xa2PvHyJB0otR+8/Sal1OK4NkLzyiQ0Ih0/vP6cHPaaFo3Q8h6T73BhY7z8PIkAgnpGCvJiDyRbjYO8/rJLB1VBajjyFMtsD5mnvP0trAaxZOoQ8YLQB8yFz7z8fPrQHIdWCvF+bezOXfO8/yQ1HO7kqibwpofUURobvP9OIOmAEtnQ89j+L5y6Q7z9xcp1R7MWDPINMx/tRmu8/8JHTjxL3j7zakKSir6TvP310I+KYro288WeOLUiv7z8IIKpBvMOOPCdaYe4buu8/Muupw5QrhDyXums3K8XvP+6F0TGpZIo8QEVuW3bQ7z/t4zvkujeOvBS+nK392+8/nc2RTTuJdzzYkJ6BwefvP4nMYEHBBVM88XGPK8Lz7z8AOPr+Qi7mPzBnx5NX8y49AAAAAAAA4L9gVVVVVVXlvwYAAAAAAOA/TlVZmZmZ6T96pClVVVXlv+lFSJtbSfK/wz8miysA8D8AAAAAAKD2PwAAAAAAAAAAAMi58oIs1r+AVjcoJLT6PAAAAAAAgPY/AAAAAAAAAAAACFi/vdHVvyD34NgIpRy9AAAAAABg9j8AAAAAAAAAAABYRRd3dtW/bVC21aRiI70AAAAAAED2PwAAAAAAAAAAAPgth60a1b/VZ7Ce5ITmvAAAAAAAIPY/AAAAAAAAAAAAeHeVX77Uv+A+KZNpGwS9AAAAAAAA9j8AAAAAAAAAAABgHMKLYdS/zIRMSC/YEz0AAAAAAOD1PwAAAAAAAAAAAKiGhjAE1L86C4Lt80LcPAAAAAAAwPU/AAAAAAAAAAAASGlVTKbTv2CUUYbGsSA9AAAAAACg9T8AAAAAAAAAAACAmJrdR9O/koDF1E1ZJT0AAAAAAID1PwAAAAAAAAAAACDhuuLo0r/YK7eZHnsmPQAAAAAAYPU/AAAAAAAAAAAAiN4TWonSvz+wz7YUyhU9AAAAAABg9T8AAAAAAAAAAACI3hNaidK/P7DPthTKFT0AAAAAAED1PwAAAAAAAAAAAHjP+0Ep0r922lMoJFoWvQAAAAAAIPU/AAAAAAAAAAAAmGnBmMjRvwRU52i8rx+9AAAAAAAA9T8AAAAAAAAAAACoq6tcZ9G/8KiCM8YfHz0AAAAAAOD0PwAAAAAAAAAAAEiu+YsF0b9mWgX9xKgmvQAAAAAAwPQ/AAAAAAAAAAAAkHPiJKPQvw4D9H7uawy9AAAAAACg9D8AAAAAAAAAAADQtJQlQNC/fy30nrg28LwAAAAAAKD0PwAAAAAAAAAAANC0lCVA0L9/LfSeuDbwvAAAAAAAgPQ/AAAAAAAAAAAAQF5tGLnPv4c8masqVw09AAAAAABg9D8AAAAAAAAAAABg3Mut8M6/JK+GnLcmKz0AAAAAAED0PwAAAAAAAAAAAPAqbgcnzr8Q/z9UTy8XvQAAAAAAIPQ/AAAAAAAAAAAAwE9rIVzNvxtoyruRuiE9AAAAAAAA9D8AAAAAAAAAAACgmsf3j8y/NISfaE95Jz0AAAAAAAD0PwAAAAAAAAAAAKCax/ePzL80hJ9oT3knPQAAAAAA4PM/AAAAAAAAAAAAkC10hsLLv4+3izGwThk9AAAAAADA8z8AAAAAAAAAAADAgE7J88q/ZpDNP2NOujwAAAAAAKDzPwAAAAAAAAAAALDiH7wjyr/qwUbcZIwlvQAAAAAAoPM/AAAAAAAAAAAAsOIfvCPKv+rBRtxkjCW9AAAAAACA8z8AAAAAAAAAAABQ9JxaUsm/49TBBNnRKr0AAAAAAGDzPwAAAAAAAAAAANAgZaB/yL8J+tt/v70rPQAAAAAAQPM/AAAAAAAAAAAA4BACiavHv1hKU3KQ2ys9AAAAAABA8z8AAAAAAAAAAADgEAKJq8e/WEpTcpDbKz0AAAAAACDzPwAAAAAAAAAAANAZ5w/Wxr9m4rKjauQQvQAAAAAAAPM/AAAAAAAAAAAAkKdwMP/FvzlQEJ9Dnh69AAAAAAAA8z8AAAAAAAAAAACQp3Aw/8W/OVAQn0OeHr0AAAAAAODyPwAAAAAAAAAAALCh4+Umxb+PWweQi94gvQAAAAAAwPI/AAAAAAAAAAAAgMtsK03Evzx4NWHBDBc9AAAAAADA8j8AAAAAAAAAAACAy2wrTcS/PHg1YcEMFz0AAAAAAKDyPwAAAAAAAAAAAJAeIPxxw786VCdNhnjxPAAAAAAAgPI/AAAAAAAAAAAA8B/4UpXCvwjEcRcwjSS9AAAAAABg8j8AAAAAAAAAAABgL9Uqt8G/lqMRGKSALr0AAAAAAGDyPwAAAAAAAAAAAGAv1Sq3wb+WoxEYpIAuvQAAAAAAQPI/AAAAAAAAAAAAkNB8ftfAv/Rb6IiWaQo9AAAAAABA8j8AAAAAAAAAAACQ0Hx+18C/9FvoiJZpCj0AAAAAACDyPwAAAAAAAAAAAODbMZHsv7/yM6NcVHUlvQAAAAAAAPI/AAAAAAAAAAAAACtuBye+vzwA8CosNCo9AAAAAAAA8j8AAAAAAAAAAAAAK24HJ76/PADwKiw0Kj0AAAAAAODxPwAAAAAAAAAAAMBbj1RevL8Gvl9YVwwdvQAAAAAAwPE/AAAAAAAAAAAA4Eo6bZK6v8iqW+g1OSU9AAAAAADA8T8AAAAAAAAAAADgSjptkrq/yKpb6DU5JT0AAAAAAKDxPwAAAAAAAAAAAKAx1kXDuL9oVi9NKXwTPQAAAAAAoPE/AAAAAAAAAAAAoDHWRcO4v2hWL00pfBM9AAAAAACA8T8AAAAAAAAAAABg5YrS8La/2nMzyTeXJr0AAAAAAGDxPwAAAAAAAAAAACAGPwcbtb9XXsZhWwIfPQAAAAAAYPE/AAAAAAAAAAAAIAY/Bxu1v1dexmFbAh89AAAAAABA8T8AAAAAAAAAAADgG5bXQbO/3xP5zNpeLD0AAAAAAEDxPwAAAAAAAAAAAOAbltdBs7/fE/nM2l4sPQAAAAAAIPE/AAAAAAAAAAAAgKPuNmWxvwmjj3ZefBQ9AAAAAAAA8T8AAAAAAAAAAACAEcAwCq+/kY42g55ZLT0AAAAAAADxPwAAAAAAAAAAAIARwDAKr7+RjjaDnlktPQAAAAAA4PA/AAAAAAAAAAAAgBlx3UKrv0xw1uV6ghw9AAAAAADg8D8AAAAAAAAAAACAGXHdQqu/THDW5XqCHD0AAAAAAMDwPwAAAAAAAAAAAMAy9lh0p7/uofI0RvwsvQAAAAAAwPA/AAAAAAAAAAAAwDL2WHSnv+6h8jRG/Cy9AAAAAACg8D8AAAAAAAAAAADA/rmHnqO/qv4m9bcC9TwAAAAAAKDwPwAAAAAAAAAAAMD+uYeeo7+q/ib1twL1PAAAAAAAgPA/AAAAAAAAAAAAAHgOm4Kfv+QJfnwmgCm9AAAAAACA8D8AAAAAAAAAAAAAeA6bgp+/5Al+fCaAKb0AAAAAAGDwPwAAAAAAAAAAAIDVBxu5l785pvqTVI0ovQAAAAAAQPA/AAAAAAAAAAAAAPywqMCPv5ym0/Z8Ht+8AAAAAABA8D8AAAAAAAAAAAAA/LCowI+/nKbT9nwe37wAAAAAACDwPwAAAAAAAAAAAAAQayrgf7/kQNoNP+IZvQAAAAAAIPA/AAAAAAAAAAAAABBrKuB/v+RA2g0/4hm9AAAAAAAA8D8AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAADwPwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAwO8/AAAAAAAAAAAAAIl1FRCAP+grnZlrxxC9AAAAAACA7z8AAAAAAAAAAACAk1hWIJA/0vfiBlvcI70AAAAAAEDvPwAAAAAAAAAAAADJKCVJmD80DFoyuqAqvQAAAAAAAO8/AAAAAAAAAAAAQOeJXUGgP1PX8VzAEQE9AAAAAADA7j8AAAAAAAAAAAAALtSuZqQ/KP29dXMWLL0AAAAAAIDuPwAAAAAAAAAAAMCfFKqUqD99JlrQlXkZvQAAAAAAQO4/AAAAAAAAAAAAwN3Nc8usPwco2EfyaBq9AAAAAAAg7j8AAAAAAAAAAADABsAx6q4/ezvJTz4RDr0AAAAAAODtPwAAAAAAAAAAAGBG0TuXsT+bng1WXTIlvQAAAAAAoO0/AAAAAAAAAAAA4NGn9b2zP9dO26VeyCw9AAAAAABg7T8AAAAAAAAAAACgl01a6bU/Hh1dPAZpLL0AAAAAAEDtPwAAAAAAAAAAAMDqCtMAtz8y7Z2pjR7sPAAAAAAAAO0/AAAAAAAAAAAAQFldXjO5P9pHvTpcESM9AAAAAADA7D8AAAAAAAAAAABgrY3Iars/5Wj3K4CQE70AAAAAAKDsPwAAAAAAAAAAAEC8AViIvD/TrFrG0UYmPQAAAAAAYOw/AAAAAAAAAAAAIAqDOce+P+BF5q9owC29AAAAAABA7D8AAAAAAAAAAADg2zmR6L8//QqhT9Y0Jb0AAAAAAADsPwAAAAAAAAAAAOAngo4XwT/yBy3OeO8hPQAAAAAA4Os/AAAAAAAAAAAA8CN+K6rBPzSZOESOpyw9AAAAAACg6z8AAAAAAAAAAACAhgxh0cI/obSBy2ydAz0AAAAAAIDrPwAAAAAAAAAAAJAVsPxlwz+JcksjqC/GPAAAAAAAQOs/AAAAAAAAAAAAsDODPZHEP3i2/VR5gyU9AAAAAAAg6z8AAAAAAAAAAACwoeTlJ8U/x31p5egzJj0AAAAAAODqPwAAAAAAAAAAABCMvk5Xxj94Ljwsi88ZPQAAAAAAwOo/AAAAAAAAAAAAcHWLEvDGP+EhnOWNESW9AAAAAACg6j8AAAAAAAAAAABQRIWNicc/BUORcBBmHL0AAAAAAGDqPwAAAAAAAAAAAAA566++yD/RLOmqVD0HvQAAAAAAQOo/AAAAAAAAAAAAAPfcWlrJP2//oFgo8gc9AAAAAAAA6j8AAAAAAAAAAADgijztk8o/aSFWUENyKL0AAAAAAODpPwAAAAAAAAAAANBbV9gxyz+q4axOjTUMvQAAAAAAwOk/AAAAAAAAAAAA4Ds4h9DLP7YSVFnESy29AAAAAACg6T8AAAAAAAAAAAAQ8Mb7b8w/0iuWxXLs8bwAAAAAAGDpPwAAAAAAAAAAAJDUsD2xzT81sBX3Kv8qvQAAAAAAQOk/AAAAAAAAAAAAEOf/DlPOPzD0QWAnEsI8AAAAAAAg6T8AAAAAAAAAAAAA3eSt9c4/EY67ZRUhyrwAAAAAAADpPwAAAAAAAAAAALCzbByZzz8w3wzK7MsbPQAAAAAAwOg/AAAAAAAAAAAAWE1gOHHQP5FO7RbbnPg8AAAAAACg6D8AAAAAAAAAAABgYWctxNA/6eo8FosYJz0AAAAAAIDoPwAAAAAAAAAAAOgngo4X0T8c8KVjDiEsvQAAAAAAYOg/AAAAAAAAAAAA+KzLXGvRP4EWpffNmis9AAAAAABA6D8AAAAAAAAAAABoWmOZv9E/t71HUe2mLD0AAAAAACDoPwAAAAAAAAAAALgObUUU0j/quka63ocKPQAAAAAA4Oc/AAAAAAAAAAAAkNx88L7SP/QEUEr6nCo9AAAAAADA5z8AAAAAAAAAAABg0+HxFNM/uDwh03riKL0AAAAAAKDnPwAAAAAAAAAAABC+dmdr0z/Id/GwzW4RPQAAAAAAgOc/AAAAAAAAAAAAMDN3UsLTP1y9BrZUOxg9AAAAAABg5z8AAAAAAAAAAADo1SO0GdQ/neCQ7DbkCD0AAAAAAEDnPwAAAAAAAAAAAMhxwo1x1D911mcJzicvvQAAAAAAIOc/AAAAAAAAAAAAMBee4MnUP6TYChuJIC69AAAAAAAA5z8AAAAAAAAAAACgOAeuItU/WcdkgXC+Lj0AAAAAAODmPwAAAAAAAAAAANDIU/d71T/vQF3u7a0fPQAAAAAAwOY/AAAAAAAAAAAAYFnfvdXVP9xlpAgqCwq9iDgAAAAAAAAZAAoAGRkZAAAAAAUAAAAAAAAJAAAAAAsAAAAAAAAAABkAEQoZGRkDCgcAAQAJCxgAAAkGCwAACwAGGQAAABkZGQAAAAAAAAAAAAAAAAAAAAAOAAAAAAAAAAAZAAoNGRkZAA0AAAIACQ4AAAAJAA4AAA4AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAADAAAAAAAAAAAAAAAEwAAAAATAAAAAAkMAAAAAAAMAAAMAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAABAAAAAAAAAAAAAAAA8AAAAEDwAAAAAJEAAAAAAAEAAAEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAASAAAAAAAAAAAAAAARAAAAABEAAAAACRIAAAAAABIAABIAABoAAAAaGhoAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAGgAAABoaGgAAAAAAAAkAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAABQAAAAAAAAAAAAAABcAAAAAFwAAAAAJFAAAAAAAFAAAFAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAWAAAAAAAAAAAAAAAVAAAAABUAAAAACRYAAAAAABYAABYAADAxMjM0NTY3ODlBQkNERUYAQcDwAAvcAQcAAAAIAAAACQAAAAoAAAALAAAADAAAAA0AAAAOAAAADwAAABAAAAARAAAA//////////82AAAANgAAADYAAAA2AAAAAAAAAAUAAAAAAAAAAAAAADwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAD0AAAA+AAAAzDkAAAAAAAAAAAAAAAAAAAIAAAAAAAAAAAAAAAAAAAD//////////wAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAMA7UAA=';
  if (!isDataURI(wasmBinaryFile)) {
    wasmBinaryFile = locateFile(wasmBinaryFile);
  }

function getBinary(file) {
  try {
    if (file == wasmBinaryFile && wasmBinary) {
      return new Uint8Array(wasmBinary);
    }
    var binary = tryParseAsDataURI(file);
    if (binary) {
      return binary;
    }
    if (readBinary) {
      return readBinary(file);
    } else {
      throw "both async and sync fetching of the wasm failed";
    }
  }
  catch (err) {
    abort(err);
  }
}

function getBinaryPromise() {
  // If we don't have the binary yet, try to to load it asynchronously.
  // Fetch has some additional restrictions over XHR, like it can't be used on a file:// url.
  // See https://github.com/github/fetch/pull/92#issuecomment-140665932
  // Cordova or Electron apps are typically loaded from a file:// url.
  // So use fetch if it is available and the url is not a file, otherwise fall back to XHR.
  if (!wasmBinary && (ENVIRONMENT_IS_WEB || ENVIRONMENT_IS_WORKER)) {
    if (typeof fetch == 'function'
    ) {
      return fetch(wasmBinaryFile, { credentials: 'same-origin' }).then(function(response) {
        if (!response['ok']) {
          throw "failed to load wasm binary file at '" + wasmBinaryFile + "'";
        }
        return response['arrayBuffer']();
      }).catch(function () {
          return getBinary(wasmBinaryFile);
      });
    }
  }

  // Otherwise, getBinary should be able to get it synchronously
  return Promise.resolve().then(function() { return getBinary(wasmBinaryFile); });
}

// Create the wasm instance.
// Receives the wasm imports, returns the exports.
function createWasm() {
  // prepare imports
  var info = {
    'env': asmLibraryArg,
    'wasi_snapshot_preview1': asmLibraryArg,
  };
  // Load the wasm module and create an instance of using native support in the JS engine.
  // handle a generated wasm instance, receiving its exports and
  // performing other necessary setup
  /** @param {WebAssembly.Module=} module*/
  function receiveInstance(instance, module) {
    var exports = instance.exports;

    Module['asm'] = exports;

    wasmMemory = Module['asm']['memory'];
    updateGlobalBufferAndViews(wasmMemory.buffer);

    wasmTable = Module['asm']['__indirect_function_table'];

    addOnInit(Module['asm']['__wasm_call_ctors']);

    removeRunDependency('wasm-instantiate');
  }
  // we can't run yet (except in a pthread, where we have a custom sync instantiator)
  addRunDependency('wasm-instantiate');

  // Prefer streaming instantiation if available.
  function receiveInstantiationResult(result) {
    // 'result' is a ResultObject object which has both the module and instance.
    // receiveInstance() will swap in the exports (to Module.asm) so they can be called
    // TODO: Due to Closure regression https://github.com/google/closure-compiler/issues/3193, the above line no longer optimizes out down to the following line.
    // When the regression is fixed, can restore the above USE_PTHREADS-enabled path.
    receiveInstance(result['instance']);
  }

  function instantiateArrayBuffer(receiver) {
    return getBinaryPromise().then(function(binary) {
      return WebAssembly.instantiate(binary, info);
    }).then(function (instance) {
      return instance;
    }).then(receiver, function(reason) {
      err('failed to asynchronously prepare wasm: ' + reason);

      abort(reason);
    });
  }

  function instantiateAsync() {
    if (!wasmBinary &&
        typeof WebAssembly.instantiateStreaming == 'function' &&
        !isDataURI(wasmBinaryFile) &&
        typeof fetch == 'function') {
      return fetch(wasmBinaryFile, { credentials: 'same-origin' }).then(function(response) {
        // Suppress closure warning here since the upstream definition for
        // instantiateStreaming only allows Promise<Repsponse> rather than
        // an actual Response.
        // TODO(https://github.com/google/closure-compiler/pull/3913): Remove if/when upstream closure is fixed.
        /** @suppress {checkTypes} */
        var result = WebAssembly.instantiateStreaming(response, info);

        return result.then(
          receiveInstantiationResult,
          function(reason) {
            // We expect the most common failure cause to be a bad MIME type for the binary,
            // in which case falling back to ArrayBuffer instantiation should work.
            err('wasm streaming compile failed: ' + reason);
            err('falling back to ArrayBuffer instantiation');
            return instantiateArrayBuffer(receiveInstantiationResult);
          });
      });
    } else {
      return instantiateArrayBuffer(receiveInstantiationResult);
    }
  }

  // User shell pages can write their own Module.instantiateWasm = function(imports, successCallback) callback
  // to manually instantiate the Wasm module themselves. This allows pages to run the instantiation parallel
  // to any other async startup actions they are performing.
  if (Module['instantiateWasm']) {
    try {
      var exports = Module['instantiateWasm'](info, receiveInstance);
      return exports;
    } catch(e) {
      err('Module.instantiateWasm callback failed with error: ' + e);
      return false;
    }
  }

  // If instantiation fails, reject the module ready promise.
  instantiateAsync().catch(readyPromiseReject);
  return {}; // no exports yet; we'll fill them in later
}

// Globals used by JS i64 conversions (see makeSetValue)
var tempDouble;
var tempI64;

// === Body ===

var ASM_CONSTS = {
  
};






  function callRuntimeCallbacks(callbacks) {
      while (callbacks.length > 0) {
        var callback = callbacks.shift();
        if (typeof callback == 'function') {
          callback(Module); // Pass the module as the first argument.
          continue;
        }
        var func = callback.func;
        if (typeof func == 'number') {
          if (callback.arg === undefined) {
            getWasmTableEntry(func)();
          } else {
            getWasmTableEntry(func)(callback.arg);
          }
        } else {
          func(callback.arg === undefined ? null : callback.arg);
        }
      }
    }

  function withStackSave(f) {
      var stack = stackSave();
      var ret = f();
      stackRestore(stack);
      return ret;
    }
  function demangle(func) {
      return func;
    }

  function demangleAll(text) {
      var regex =
        /\b_Z[\w\d_]+/g;
      return text.replace(regex,
        function(x) {
          var y = demangle(x);
          return x === y ? x : (y + ' [' + x + ']');
        });
    }

  var wasmTableMirror = [];
  function getWasmTableEntry(funcPtr) {
      var func = wasmTableMirror[funcPtr];
      if (!func) {
        if (funcPtr >= wasmTableMirror.length) wasmTableMirror.length = funcPtr + 1;
        wasmTableMirror[funcPtr] = func = wasmTable.get(funcPtr);
      }
      return func;
    }

  function handleException(e) {
      // Certain exception types we do not treat as errors since they are used for
      // internal control flow.
      // 1. ExitStatus, which is thrown by exit()
      // 2. "unwind", which is thrown by emscripten_unwind_to_js_event_loop() and others
      //    that wish to return to JS event loop.
      if (e instanceof ExitStatus || e == 'unwind') {
        return EXITSTATUS;
      }
      quit_(1, e);
    }

  function jsStackTrace() {
      var error = new Error();
      if (!error.stack) {
        // IE10+ special cases: It does have callstack info, but it is only populated if an Error object is thrown,
        // so try that as a special-case.
        try {
          throw new Error();
        } catch(e) {
          error = e;
        }
        if (!error.stack) {
          return '(no stack trace available)';
        }
      }
      return error.stack.toString();
    }

  function setWasmTableEntry(idx, func) {
      wasmTable.set(idx, func);
      wasmTableMirror[idx] = func;
    }

  function stackTrace() {
      var js = jsStackTrace();
      if (Module['extraStackTrace']) js += '\n' + Module['extraStackTrace']();
      return demangleAll(js);
    }

  function _abort() {
      abort('');
    }

  function _emscripten_memcpy_big(dest, src, num) {
      HEAPU8.copyWithin(dest, src, src + num);
    }

  function _emscripten_get_heap_max() {
      // Stay one Wasm page short of 4GB: while e.g. Chrome is able to allocate
      // full 4GB Wasm memories, the size will wrap back to 0 bytes in Wasm side
      // for any code that deals with heap sizes, which would require special
      // casing all heap size related code to treat 0 specially.
      return 2147483648;
    }
  
  function emscripten_realloc_buffer(size) {
      try {
        // round size grow request up to wasm page size (fixed 64KB per spec)
        wasmMemory.grow((size - buffer.byteLength + 65535) >>> 16); // .grow() takes a delta compared to the previous size
        updateGlobalBufferAndViews(wasmMemory.buffer);
        return 1 /*success*/;
      } catch(e) {
      }
      // implicit 0 return to save code size (caller will cast "undefined" into 0
      // anyhow)
    }
  function _emscripten_resize_heap(requestedSize) {
      var oldSize = HEAPU8.length;
      requestedSize = requestedSize >>> 0;
      // With pthreads, races can happen (another thread might increase the size
      // in between), so return a failure, and let the caller retry.
  
      // Memory resize rules:
      // 1.  Always increase heap size to at least the requested size, rounded up
      //     to next page multiple.
      // 2a. If MEMORY_GROWTH_LINEAR_STEP == -1, excessively resize the heap
      //     geometrically: increase the heap size according to
      //     MEMORY_GROWTH_GEOMETRIC_STEP factor (default +20%), At most
      //     overreserve by MEMORY_GROWTH_GEOMETRIC_CAP bytes (default 96MB).
      // 2b. If MEMORY_GROWTH_LINEAR_STEP != -1, excessively resize the heap
      //     linearly: increase the heap size by at least
      //     MEMORY_GROWTH_LINEAR_STEP bytes.
      // 3.  Max size for the heap is capped at 2048MB-WASM_PAGE_SIZE, or by
      //     MAXIMUM_MEMORY, or by ASAN limit, depending on which is smallest
      // 4.  If we were unable to allocate as much memory, it may be due to
      //     over-eager decision to excessively reserve due to (3) above.
      //     Hence if an allocation fails, cut down on the amount of excess
      //     growth, in an attempt to succeed to perform a smaller allocation.
  
      // A limit is set for how much we can grow. We should not exceed that
      // (the wasm binary specifies it, so if we tried, we'd fail anyhow).
      var maxHeapSize = _emscripten_get_heap_max();
      if (requestedSize > maxHeapSize) {
        return false;
      }
  
      let alignUp = (x, multiple) => x + (multiple - x % multiple) % multiple;
  
      // Loop through potential heap size increases. If we attempt a too eager
      // reservation that fails, cut down on the attempted size and reserve a
      // smaller bump instead. (max 3 times, chosen somewhat arbitrarily)
      for (var cutDown = 1; cutDown <= 4; cutDown *= 2) {
        var overGrownHeapSize = oldSize * (1 + 0.2 / cutDown); // ensure geometric growth
        // but limit overreserving (default to capping at +96MB overgrowth at most)
        overGrownHeapSize = Math.min(overGrownHeapSize, requestedSize + 100663296 );
  
        var newSize = Math.min(maxHeapSize, alignUp(Math.max(requestedSize, overGrownHeapSize), 65536));
  
        var replacement = emscripten_realloc_buffer(newSize);
        if (replacement) {
  
          return true;
        }
      }
      return false;
    }

  var SYSCALLS = {buffers:[null,[],[]],printChar:function(stream, curr) {
        var buffer = SYSCALLS.buffers[stream];
        if (curr === 0 || curr === 10) {
          (stream === 1 ? out : err)(UTF8ArrayToString(buffer, 0));
          buffer.length = 0;
        } else {
          buffer.push(curr);
        }
      },varargs:undefined,get:function() {
        SYSCALLS.varargs += 4;
        var ret = HEAP32[(((SYSCALLS.varargs)-(4))>>2)];
        return ret;
      },getStr:function(ptr) {
        var ret = UTF8ToString(ptr);
        return ret;
      },get64:function(low, high) {
        return low;
      }};
  function _fd_close(fd) {
      return 0;
    }

  function _fd_seek(fd, offset_low, offset_high, whence, newOffset) {
  }

  function flush_NO_FILESYSTEM() {
      // flush anything remaining in the buffers during shutdown
      var buffers = SYSCALLS.buffers;
      if (buffers[1].length) SYSCALLS.printChar(1, 10);
      if (buffers[2].length) SYSCALLS.printChar(2, 10);
    }
  function _fd_write(fd, iov, iovcnt, pnum) {
      ;
      // hack to support printf in SYSCALLS_REQUIRE_FILESYSTEM=0
      var num = 0;
      for (var i = 0; i < iovcnt; i++) {
        var ptr = HEAP32[((iov)>>2)];
        var len = HEAP32[(((iov)+(4))>>2)];
        iov += 8;
        for (var j = 0; j < len; j++) {
          SYSCALLS.printChar(fd, HEAPU8[ptr+j]);
        }
        num += len;
      }
      HEAP32[((pnum)>>2)] = num;
      return 0;
    }

  function _setTempRet0(val) {
      setTempRet0(val);
    }
var ASSERTIONS = false;



/** @type {function(string, boolean=, number=)} */
function intArrayFromString(stringy, dontAddNull, length) {
  var len = length > 0 ? length : lengthBytesUTF8(stringy)+1;
  var u8array = new Array(len);
  var numBytesWritten = stringToUTF8Array(stringy, u8array, 0, u8array.length);
  if (dontAddNull) u8array.length = numBytesWritten;
  return u8array;
}

function intArrayToString(array) {
  var ret = [];
  for (var i = 0; i < array.length; i++) {
    var chr = array[i];
    if (chr > 0xFF) {
      if (ASSERTIONS) {
        assert(false, 'Character code ' + chr + ' (' + String.fromCharCode(chr) + ')  at offset ' + i + ' not in 0x00-0xFF.');
      }
      chr &= 0xFF;
    }
    ret.push(String.fromCharCode(chr));
  }
  return ret.join('');
}


// Copied from https://github.com/strophe/strophejs/blob/e06d027/src/polyfills.js#L149

// This code was written by Tyler Akins and has been placed in the
// public domain.  It would be nice if you left this header intact.
// Base64 code from Tyler Akins -- http://rumkin.com

/**
 * Decodes a base64 string.
 * @param {string} input The string to decode.
 */
var decodeBase64 = typeof atob == 'function' ? atob : function (input) {
  var keyStr = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=';

  var output = '';
  var chr1, chr2, chr3;
  var enc1, enc2, enc3, enc4;
  var i = 0;
  // remove all characters that are not A-Z, a-z, 0-9, +, /, or =
  input = input.replace(/[^A-Za-z0-9\+\/\=]/g, '');
  do {
    enc1 = keyStr.indexOf(input.charAt(i++));
    enc2 = keyStr.indexOf(input.charAt(i++));
    enc3 = keyStr.indexOf(input.charAt(i++));
    enc4 = keyStr.indexOf(input.charAt(i++));

    chr1 = (enc1 << 2) | (enc2 >> 4);
    chr2 = ((enc2 & 15) << 4) | (enc3 >> 2);
    chr3 = ((enc3 & 3) << 6) | enc4;

    output = output + String.fromCharCode(chr1);

    if (enc3 !== 64) {
      output = output + String.fromCharCode(chr2);
    }
    if (enc4 !== 64) {
      output = output + String.fromCharCode(chr3);
    }
  } while (i < input.length);
  return output;
};

// Converts a string of base64 into a byte array.
// Throws error on invalid input.
function intArrayFromBase64(s) {

  try {
    var decoded = decodeBase64(s);
    var bytes = new Uint8Array(decoded.length);
    for (var i = 0 ; i < decoded.length ; ++i) {
      bytes[i] = decoded.charCodeAt(i);
    }
    return bytes;
  } catch (_) {
    throw new Error('Converting base64 string to bytes failed.');
  }
}

// If filename is a base64 data URI, parses and returns data (Buffer on node,
// Uint8Array otherwise). If filename is not a base64 data URI, returns undefined.
function tryParseAsDataURI(filename) {
  if (!isDataURI(filename)) {
    return;
  }

  return intArrayFromBase64(filename.slice(dataURIPrefix.length));
}


var asmLibraryArg = {
  "abort": _abort,
  "emscripten_memcpy_big": _emscripten_memcpy_big,
  "emscripten_resize_heap": _emscripten_resize_heap,
  "fd_close": _fd_close,
  "fd_seek": _fd_seek,
  "fd_write": _fd_write,
  "setTempRet0": _setTempRet0
};
var asm = createWasm();
/** @type {function(...*):?} */
var ___wasm_call_ctors = Module["___wasm_call_ctors"] = function() {
  return (___wasm_call_ctors = Module["___wasm_call_ctors"] = Module["asm"]["__wasm_call_ctors"]).apply(null, arguments);
};

/** @type {function(...*):?} */
var _munk_run = Module["_munk_run"] = function() {
  return (_munk_run = Module["_munk_run"] = Module["asm"]["munk_run"]).apply(null, arguments);
};

/** @type {function(...*):?} */
var _free = Module["_free"] = function() {
  return (_free = Module["_free"] = Module["asm"]["free"]).apply(null, arguments);
};

/** @type {function(...*):?} */
var ___errno_location = Module["___errno_location"] = function() {
  return (___errno_location = Module["___errno_location"] = Module["asm"]["__errno_location"]).apply(null, arguments);
};

/** @type {function(...*):?} */
var _malloc = Module["_malloc"] = function() {
  return (_malloc = Module["_malloc"] = Module["asm"]["malloc"]).apply(null, arguments);
};

/** @type {function(...*):?} */
var stackSave = Module["stackSave"] = function() {
  return (stackSave = Module["stackSave"] = Module["asm"]["stackSave"]).apply(null, arguments);
};

/** @type {function(...*):?} */
var stackRestore = Module["stackRestore"] = function() {
  return (stackRestore = Module["stackRestore"] = Module["asm"]["stackRestore"]).apply(null, arguments);
};

/** @type {function(...*):?} */
var stackAlloc = Module["stackAlloc"] = function() {
  return (stackAlloc = Module["stackAlloc"] = Module["asm"]["stackAlloc"]).apply(null, arguments);
};

/** @type {function(...*):?} */
var dynCall_jiji = Module["dynCall_jiji"] = function() {
  return (dynCall_jiji = Module["dynCall_jiji"] = Module["asm"]["dynCall_jiji"]).apply(null, arguments);
};





// === Auto-generated postamble setup entry stuff ===



var calledRun;

/**
 * @constructor
 * @this {ExitStatus}
 */
function ExitStatus(status) {
  this.name = "ExitStatus";
  this.message = "Program terminated with exit(" + status + ")";
  this.status = status;
}

var calledMain = false;

dependenciesFulfilled = function runCaller() {
  // If run has never been called, and we should call run (INVOKE_RUN is true, and Module.noInitialRun is not false)
  if (!calledRun) run();
  if (!calledRun) dependenciesFulfilled = runCaller; // try this again later, after new deps are fulfilled
};

/** @type {function(Array=)} */
function run(args) {
  args = args || arguments_;

  if (runDependencies > 0) {
    return;
  }

  preRun();

  // a preRun added a dependency, run will be called later
  if (runDependencies > 0) {
    return;
  }

  function doRun() {
    // run may have just been called through dependencies being fulfilled just in this very frame,
    // or while the async setStatus time below was happening
    if (calledRun) return;
    calledRun = true;
    Module['calledRun'] = true;

    if (ABORT) return;

    initRuntime();

    readyPromiseResolve(Module);
    if (Module['onRuntimeInitialized']) Module['onRuntimeInitialized']();

    postRun();
  }

  if (Module['setStatus']) {
    Module['setStatus']('Running...');
    setTimeout(function() {
      setTimeout(function() {
        Module['setStatus']('');
      }, 1);
      doRun();
    }, 1);
  } else
  {
    doRun();
  }
}
Module['run'] = run;

/** @param {boolean|number=} implicit */
function exit(status, implicit) {
  EXITSTATUS = status;

  if (keepRuntimeAlive()) {
  } else {
    exitRuntime();
  }

  procExit(status);
}

function procExit(code) {
  EXITSTATUS = code;
  if (!keepRuntimeAlive()) {
    if (Module['onExit']) Module['onExit'](code);
    ABORT = true;
  }
  quit_(code, new ExitStatus(code));
}

if (Module['preInit']) {
  if (typeof Module['preInit'] == 'function') Module['preInit'] = [Module['preInit']];
  while (Module['preInit'].length > 0) {
    Module['preInit'].pop()();
  }
}

run();







  return Module.ready
}
);
})();
export default Module;